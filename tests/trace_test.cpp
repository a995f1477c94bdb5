// Traversal on a tree of seven nodes that was worked by hand: which nodes are visited, in which order, and what counts.

#include <gtest/gtest.h>

#include "kerf/layout/bvh2.h"
#include "kerf/trace/brute_force.h"
#include "kerf/trace/trace_bvh2.h"
#include "tests/support/hand_tree.h"

namespace kerf {
namespace {

using test::expect_counts;

class SevenNodes : public testing::Test {
 protected:
  SevenNodes() : tracer_{make_bvh2(test::SevenNodes::bvh()), hand_.scene.geometries()} {
    EXPECT_EQ(find_fault(make_bvh(tracer_.layout), tracer_.geometries, 1), std::nullopt);
  }

  struct Outcome {
    Hit hit;
    TraceCounts counts;
  };
  Outcome closest(const Ray& ray) const {
    Outcome outcome;
    outcome.hit = bvh2_table().closest_counted(&tracer_, ray, outcome.counts);
    EXPECT_EQ(bvh2_table().closest(&tracer_, ray), outcome.hit);
    return outcome;
  }

  test::SevenNodes hand_;
  Bvh2Tracer tracer_;
};

TEST_F(SevenNodes, NearChildFirstAndChildrenBehindTheHitAreSkipped) {
  const auto [hit, counts] = closest({.origin = {0, 0.25F, 0.25F}, .direction = {1, 0, 0}});
  EXPECT_EQ(hit.primitive, 0U);
  EXPECT_EQ(hit.t, 1);
  EXPECT_EQ(hit.u, 0.25F);
  EXPECT_EQ(hit.v, 0.25F);
  expect_counts(counts, 3, 1, 5);  // nodes 0, 1, 3; the boxes of 0, 1, 2, 3, 4
}

TEST_F(SevenNodes, TheOtherWayRoundTheSecondChildIsNear) {
  const auto [hit, counts] = closest({.origin = {10, 0.25F, 0.25F}, .direction = {-2, 0, 0}});
  EXPECT_EQ(hit.primitive, 3U);
  EXPECT_EQ(hit.t, 3);
  expect_counts(counts, 3, 1, 5);  // nodes 0, 2, 6
}

TEST_F(SevenNodes, ARayThroughAllBoxesAndNoTriangleVisitsAll) {
  const auto [hit, counts] = closest({.origin = {0, 0.75F, 0.75F}, .direction = {1, 0, 0}});
  EXPECT_FALSE(hit);
  EXPECT_EQ(hit, Hit{});
  expect_counts(counts, 7, 4, 7);
}

TEST_F(SevenNodes, ARayBesideTheRootTestsOneBoxAndEntersNone) {
  const auto [hit, counts] = closest({.origin = {0, 2, 0.25F}, .direction = {1, 0, 0}});
  EXPECT_FALSE(hit);
  expect_counts(counts, 0, 0, 1);
}

TEST_F(SevenNodes, TheIntervalCullsBoxesAtBothEnds) {
  const Vec3f origin{0, 0.25F, 0.25F}, x{1, 0, 0};
  const auto second = closest({.origin = origin, .t_min = 1.5F, .direction = x});
  EXPECT_EQ(second.hit.primitive, 1U);
  expect_counts(second.counts, 3, 1, 5);  // nodes 0, 1, 4
  const auto none = closest({.origin = origin, .t_min = 2.5F, .direction = x, .t_max = 2.75F});
  EXPECT_FALSE(none.hit);
  expect_counts(none.counts, 1, 0, 3);  // the root only
  const auto ends = closest({.origin = origin, .t_min = 2, .direction = x, .t_max = 2});
  EXPECT_EQ(ends.hit.primitive, 1U);
}

TEST_F(SevenNodes, AnyHitStopsAtTheFirst) {
  TraceCounts counts;
  EXPECT_TRUE(bvh2_table().any_counted(&tracer_, {.origin = {0, 0.25F, 0.25F}, .direction = {1, 0, 0}}, counts));
  expect_counts(counts, 3, 1, 5);
  EXPECT_FALSE(bvh2_table().any(&tracer_, {.origin = {0, 0.75F, 0.75F}, .direction = {1, 0, 0}}));
}

TEST_F(SevenNodes, ParallelToTheTrianglesAndOnTheirPlanesNothingIsHitOrLost) {
  // Along y at x = 2, in the plane of triangle 1, with a direction of two zeros.
  EXPECT_FALSE(closest({.origin = {2, -1, 0.25F}, .direction = {0, 1, 0}}).hit);
  // Through the corner and the edges, where the ray touches sides of boxes.
  EXPECT_EQ(closest({.origin = {0, 0, 0}, .direction = {1, 0, 0}}).hit.primitive, 0U);
  EXPECT_EQ(closest({.origin = {0, 1, 0}, .direction = {1, 0, 0}}).hit.primitive, 0U);
  EXPECT_EQ(closest({.origin = {1.5F, 0, 1}, .direction = {1, -0.0F, 0}}).hit.primitive, 1U);
}

TEST_F(SevenNodes, BruteForceCountsEveryPrimitive) {
  const std::vector<LeafSlot> slots{{0, 0}, {0, 1}, {0, 2}, {0, 3}};
  const BruteForce brute(hand_.scene.geometries(), slots);
  TraceCounts counts;
  const Hit hit =
      brute_force_table().closest_counted(&brute, {.origin = {0, 0.25F, 0.25F}, .direction = {1, 0, 0}}, counts);
  EXPECT_EQ(hit.primitive, 0U);
  expect_counts(counts, 0, 4, 0);
}

TEST(Bvh2Layout, ASingleLeafIsTheRoot) {
  const Vec3f vertices[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const TriangleCorners corners[] = {{0, 1, 2}};
  const Geometry geometry{TriangleMesh{std::span<const Vec3f>(vertices), std::span<const TriangleCorners>(corners)}};
  Bvh bvh;
  bvh.nodes = {{{0, 0, 0}, 0, {1, 1, 0}, 1}};
  bvh.slots = {{0, 0}};
  const Bvh2Tracer tracer{make_bvh2(std::move(bvh)), {&geometry, 1}};
  TraceCounts counts;
  EXPECT_TRUE(bvh2_table().closest_counted(&tracer, {.origin = {0.2F, 0.2F, 1}, .direction = {0, 0, -1}}, counts));
  expect_counts(counts, 1, 1, 1);
  const Bvh2Tracer empty{make_bvh2({}), {&geometry, 1}};
  EXPECT_FALSE(bvh2_table().closest(&empty, {.origin = {0.2F, 0.2F, 1}, .direction = {0, 0, -1}}));
}

}  // namespace
}  // namespace kerf
