#pragma once

#include <limits>

#include "kerf/base/work_limit.h"
#include "kerf/references/clipper.h"
#include "kerf/references/split_result.h"

namespace kerf {

/// How far to split. See early_split().
struct EarlySplit {
  /// Boxes with a larger surface area (six faces, squared scene units) are cut; infinite: none is.
  double sa_max = std::numeric_limits<double>::infinity();
  /// At most this many references for each primitive on average, at least 1. Where sa_max would need more, it is raised
  /// until the count fits: the same value for all primitives, so their order does not matter.
  double cap = 16;

  /// As finely as a total of `budget` references per primitive allows.
  static EarlySplit with_budget(double budget) { return {std::numeric_limits<double>::min(), budget}; }
};

/// Early split clipping (Ernst and Greiner: Early Split Clipping for Bounding Volume Hierarchies, 2007, Algorithm 4):
/// while the surface area of a primitive's box is above sa_max, it is cut in the middle of its longest side and
/// replaced by the tight boxes of the two parts; parts that are empty are dropped. Takes and gives references in the
/// caller's order, pieces of one primitive side by side. Parallel; the outcome does not depend on the number of
/// threads. Ends for every input: a box that has no float between its sides is not cut further. Throws
/// Error(invalid_option) if sa_max is not above 0 or cap is not at least 1 (NaN included), Error(stopped) at the limit.
SplitResult early_split(std::span<const Reference> whole, const Clipper& clipper, const EarlySplit& options,
                        const WorkLimit& limit = {});

}  // namespace kerf
