// No ray from inside a closed mesh gets out. watertight_large_test is the same with ten million rays.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "kerf/scene/scene.h"
#include "tests/support/random.h"
#include "tests/support/watertight.h"

namespace kerf::test {
namespace {

TEST(Watertight, TheSolidsAreClosedManifolds) {
  for (const Solid& solid : {icosphere(1), icosphere(4), torus(0.3, 60, 24), sliver_tower(10, 2000), cog(9)}) {
    EXPECT_EQ(count_open_edges(solid.triangles), 0U) << solid.name;
    for (const Vec3d& p : solid.inner)
      EXPECT_NEAR(winding_number(place(solid, 1, {}), to_float(p)), 1, 1e-6) << solid.name;
    EXPECT_NEAR(winding_number(place(solid, 1, {}), {30, 20, 10}), 0, 1e-6) << solid.name;
  }
  std::vector<TriangleCorners> holed = cog(9).triangles;
  holed.pop_back();
  EXPECT_EQ(count_open_edges(holed), 3U);
}

TEST(Watertight, NoRayGetsOut) {
  expect_watertight({icosphere(3), torus(0.3, 40, 16), sliver_tower(10, 250), cog(9)}, 200'000);
}

/// A box of three parallelograms and six triangles with equal corners, sheared, aimed at along all its edges.
TEST(Watertight, NoRayGetsOutBetweenTrianglesAndParallelograms) {
  Random random(5);
  for (int box = 0; box < 50; ++box) {
    const auto whole = [&] { return std::round(50 * random.unit()); };
    // Whole numbers, so that both kinds compute the very same corners.
    const Vec3f p{whole(), whole(), whole()}, u{40 + whole() / 4, std::round(whole() / 4), 3};
    const Vec3f v{-2, 50 + std::round(whole() / 4), 5}, w{std::round(whole() / 4), 4, 45};
    const std::vector<Parallelogram> lower{{p, u, v}, {p, v, w}, {p, w, u}};
    const Vec3f q = p + u + v + w;
    const std::vector<Vec3f> corners{p, p + u, p + v, p + w, p + u + v, p + v + w, p + w + u, q};
    const std::vector<TriangleCorners> upper{{7, 4, 1}, {7, 1, 6}, {7, 5, 2}, {7, 2, 4}, {7, 6, 3}, {7, 3, 5}};
    Scene scene;
    scene.add(Strided<Parallelogram>(lower.data(), lower.size()));
    scene.add(TriangleMesh{{corners.data(), corners.size()}, {upper.data(), upper.size()}});
    scene.build({.structure = box % 2 == 0 ? "binned_sah" : "early_split(budget=2)+binned_sah"});
    const Vec3f inside = p + 0.3F * u + 0.4F * v + 0.6F * w;
    for (int i = 0; i < 1000; ++i) {
      const Vec3f a = corners[random.below(8)], b = corners[random.below(8)];
      const Vec3f target = i % 3 == 0 ? a : a + random.share() * (b - a);
      EXPECT_TRUE(scene.closest_hit({.origin = inside, .direction = target - inside}));
    }
  }
}

}  // namespace
}  // namespace kerf::test
