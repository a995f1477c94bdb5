#pragma once

#include <span>

#include "kerf/layout/skip_pointer.h"
#include "kerf/trace/trace_table.h"

namespace kerf {

/// Traces rays through a SkipPointerBvh, one at a time and without a stack: the first child always first. A box is
/// tested when its turn comes, against the hit so far.
struct SkipPointerTracer {
  SkipPointerBvh layout;
  std::span<const Geometry> geometries;

  template <bool kAny, class Counts>
  Hit trace(const Ray& ray, Counts& counts) const;
};

const TraceTable& skip_pointer_table();

}  // namespace kerf
