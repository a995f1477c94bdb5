#pragma once

#include <span>
#include <string_view>

#include "kerf/base/options.h"
#include "kerf/base/work_limit.h"
#include "kerf/tree/bvh.h"

namespace kerf {

/// One optimiser of the menu: a tree in, a better tree over the same slots out, whatever made it.
struct OptimiserEntry {
  std::string_view name;
  std::string_view sentence;
  std::string_view source;
  std::span<const OptionSpec> options;
  Bvh (*optimise)(Bvh bvh, const OptionValues& options, const WorkLimit& limit);
  size_t bytes_per_reference;  ///< what it takes for each slot at its peak, at most, both trees included
};

/// All optimisers. The same tree gives the same, byte for byte, for any number of threads.
std::span<const OptimiserEntry> optimisers();

Bvh optimise_reinsertion(Bvh bvh, const OptionValues& options, const WorkLimit& limit);

}  // namespace kerf
