// Traversal on a tree of seven nodes that was worked by hand: which nodes are visited, in which order, and what counts.

#include <gtest/gtest.h>

#include "kerf/layout/bvh2.h"
#include "kerf/trace/brute_force.h"
#include "kerf/trace/trace_bvh2.h"

namespace kerf {
namespace {

/// Four triangles across the x axis, at x = 1, 2, 3 and 4, each alone in its leaf:
///
///            0 [1,4]
///       1 [1,2]   2 [3,4]
///     3 [1]  4 [2]  5 [3]  6 [4]
///
/// They cover y + z <= 1 with y, z >= 0; their boxes the whole unit square.
class SevenNodes : public testing::Test {
 protected:
  SevenNodes() {
    for (uint32_t i = 0; i < 4; ++i) {
      const float x = static_cast<float>(i) + 1;
      vertices_.insert(vertices_.end(), {{x, 0, 0}, {x, 1, 0}, {x, 0, 1}});
      triangles_.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    geometry_ = {TriangleMesh{std::span<const Vec3f>(vertices_), std::span<const TriangleCorners>(triangles_)}};
    Bvh bvh;
    bvh.nodes = {inner(1, 4, 1), inner(1, 2, 3), inner(3, 4, 5), leaf(0), leaf(1), leaf(2), leaf(3)};
    for (uint32_t i = 0; i < 4; ++i) bvh.slots.push_back({0, i});
    EXPECT_EQ(find_fault(bvh, {&geometry_, 1}, 1), std::nullopt);
    tracer_.layout = make_bvh2(std::move(bvh));
    tracer_.geometries = {&geometry_, 1};
  }

  static BvhNode inner(float from, float to, uint32_t first) { return {{from, 0, 0}, first, {to, 1, 1}, 0}; }
  static BvhNode leaf(uint32_t slot) {
    const float x = static_cast<float>(slot) + 1;
    return {{x, 0, 0}, slot, {x, 1, 1}, 1};
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

  std::vector<Vec3f> vertices_;
  std::vector<TriangleCorners> triangles_;
  Geometry geometry_;
  Bvh2Tracer tracer_;
};

void expect_counts(const TraceCounts& counts, uint64_t nodes, uint64_t primitives, uint64_t boxes) {
  EXPECT_EQ(counts.nodes, nodes);
  EXPECT_EQ(counts.primitives, primitives);
  EXPECT_EQ(counts.boxes, boxes);
}

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
  const BruteForce brute({&geometry_, 1}, slots);
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
