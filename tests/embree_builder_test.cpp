// Embree's trees taken over: leaves, splits by our clip, quality beside our own. What holds for every structure is in
// structures_test and nasty_test, which go through the menu.

#include <gtest/gtest.h>

#include <string>

#include "kerf/base/error.h"
#include "kerf/scene/menu.h"
#include "kerf/scene/scene.h"
#include "kerf/study/embree_builder.h"
#include "tests/support/random_scene.h"
#include "tests/support/structure_check.h"

namespace kerf::test {
namespace {

class EmbreeBuilder : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_embree()) GTEST_SKIP() << "this build does not know Embree";
  }

  /// Rods across the scene among small triangles, or small ones only.
  static BuildReport build(const std::string& structure, uint32_t rods = 0) {
    RandomTriangles triangles(3000);
    for (uint32_t i = 0; i < rods; ++i) {
      const float at = 0.02F * static_cast<float>(i);
      const auto first = static_cast<uint32_t>(triangles.vertices.size());
      triangles.vertices.insert(triangles.vertices.end(), {{-10, -10 + at, -10}, {10, 10, 10 - at}, {10, 10.1F, 10}});
      triangles.triangles.push_back({first, first + 1, first + 2});
    }
    Scene scene;
    scene.add(triangles.geometry());
    const BuildReport report = scene.build({.structure = structure});
    EXPECT_EQ(scene.structure().find_fault(), std::nullopt) << structure;
    EXPECT_EQ(find_outer_fault(scene), std::nullopt) << structure;
    return report;
  }
};

TEST_F(EmbreeBuilder, LeavesAreAsLargeAsAskedFor) {
  for (const char* builder : {"embree_medium", "embree_high"}) {
    for (const uint32_t leaf : {1U, 2U, 8U}) {
      EXPECT_LE(build(std::string(builder) + "(leaf=" + std::to_string(leaf) + ")").largest_leaf, leaf);
    }
    EXPECT_LE(build(builder).largest_leaf, 4U);
    EXPECT_THROW(build(std::string(builder) + "(leaf=33)"), Error);
  }
}

TEST_F(EmbreeBuilder, HighSplitsWithinItsBudgetAndMediumDoesNot) {
  EXPECT_EQ(build("embree_medium", 300).references, 3300U);
  const BuildReport plain = build("embree_high(budget=1)", 300), some = build("embree_high(budget=1.2)", 300),
                    many = build("embree_high", 300);
  EXPECT_EQ(plain.references, 3300U);
  EXPECT_GT(some.references, 3300U);
  EXPECT_LE(some.references, 3960U);
  EXPECT_GT(many.references, some.references);
  EXPECT_LE(many.references, 6600U);
  EXPECT_LT(many.sah_cost, 0.9 * plain.sah_cost);
}

TEST_F(EmbreeBuilder, BinnedSahIsAsGoodAsMedium) {
  for (const uint32_t rods : {0U, 300U}) {
    EXPECT_NEAR(build("binned_sah", rods).sah_cost / build("embree_medium", rods).sah_cost, 1, 0.05) << rods;
  }
}

TEST_F(EmbreeBuilder, NamesStandInTheMenuOnce) { EXPECT_THROW(add_embree_builders(), Error); }

}  // namespace
}  // namespace kerf::test
