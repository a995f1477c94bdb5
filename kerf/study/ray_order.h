#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kerf/geometry/ray.h"

namespace kerf {

/// The numbers of the rays in an order in which those that go alike follow each other: by the signs of the direction,
/// then by origin and direction along a space-filling curve. The same for the same rays; equal ones stay in order.
std::vector<uint32_t> ray_order(std::span<const Ray> rays);

}  // namespace kerf
