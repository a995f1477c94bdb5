// No ray of ten million from inside a closed mesh gets out.

#include <gtest/gtest.h>

#include "tests/support/watertight.h"

namespace kerf::test {
namespace {

TEST(WatertightLarge, NoRayOfTenMillionGetsOut) {
  expect_watertight({icosphere(4), torus(0.3, 60, 24), sliver_tower(10, 2000), cog(9)}, 10'000'000);
}

}  // namespace
}  // namespace kerf::test
