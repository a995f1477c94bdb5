#pragma once

#include <span>

#include "kerf/build/kd_plane.h"
#include "kerf/references/reference.h"

namespace kerf {

inline constexpr uint32_t kMostKdSamples = 64;

/// The cheapest of some planes, found by counting and without sorting (Hunt, Mark, Stoll: Fast kd-tree construction
/// with an adaptive error-bounded heuristic, 2006): `samples` positions evenly across each axis, then as many again
/// where the references come and go fastest, and the two sides of all references' box, which cut off empty space.
KdPlane cheapest_sampled_plane(std::span<const Reference> references, const Box3f& cell, const KdCosts& costs,
                               uint32_t samples);

}  // namespace kerf
