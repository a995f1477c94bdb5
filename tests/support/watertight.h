// Rays from inside closed meshes that must not get out: shared by the quick and the long test.

#pragma once

#include <cstddef>
#include <vector>

#include "tests/support/meshes.h"

namespace kerf::test {

/// Sends about `rays` rays from inside the solids, at many sizes and places, plain and split, at corners, at points of
/// edges and anywhere; adds a test failure that shows the first ray that gets out of each.
void expect_watertight(const std::vector<Solid>& solids, size_t rays);

}  // namespace kerf::test
