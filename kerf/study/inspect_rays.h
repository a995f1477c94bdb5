#pragma once

#include <span>
#include <vector>

#include "kerf/scene/scene.h"

namespace kerf {

/// What rays did, in sum and by primitive.
struct RayTally {
  TraceCounts counts;
  uint64_t hit_count = 0;
  PrimitiveTally tests, hits;  ///< hits: rays that end there
};

/// Traces the rays with all threads of the caller; the same for any number.
RayTally tally_rays(const Scene& scene, std::span<const Ray> rays);

/// The median of several runs over the rays on one thread, for each scene; they take turns.
std::vector<double> time_rays(std::span<const Scene* const> scenes, std::span<const Ray> rays);

}  // namespace kerf
