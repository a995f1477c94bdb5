#pragma once

#include "kerf/scene/pipeline.h"

namespace kerf {

/// The memory that building takes, besides the caller's: what can be said of it before any work is done.
struct MemoryNeed {
  static constexpr size_t kUnbounded = static_cast<size_t>(-1);

  size_t least = 0;  ///< a limit below this is refused
  size_t most = 0;   ///< no scene takes more; unbounded where that depends on how primitives lie
  /// How many references may be made so that a limit of bytes is kept, whatever the scene.
  size_t most_references = kUnbounded;
};

/// Of a pipeline over so many primitives; `most_references` is for a limit of `bytes`.
MemoryNeed memory_need(const Pipeline& pipeline, size_t primitives, size_t bytes = MemoryNeed::kUnbounded);

}  // namespace kerf
