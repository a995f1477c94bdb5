// Late split clipping: a tree worked by hand, the special traversal, caps, depth, faults.

#include <gtest/gtest.h>

#include <atomic>

#include "kerf/base/rounding.h"
#include "kerf/build/builders.h"
#include "kerf/build/late_split.h"
#include "kerf/build/top_down.h"
#include "kerf/scene/scene.h"
#include "kerf/trace/trace_late_split.h"
#include "tests/support/error_of.h"
#include "tests/support/random_scene.h"

namespace kerf::test {
namespace {

/// Two triangles over [0,4] x [0,4], at z = 0 and z = 8, each alone in its leaf: one along the diagonal side y <= x,
/// the other small. Cut until the area is at most 16:
///
///   root [0,4] x [0,4] x [0,8]
///     A [0,4] x [0,4] x 0: area 32, cut at x = 2
///       A1 [0,2] x [0,2]: area 8
///       A2 [2,4] x [0,4]: area 16
///     B [0,1] x [0,1] x 8: area 2, whole
class TwoLeaves : public testing::Test {
 protected:
  TwoLeaves() {
    const Bvh bvh{{{{0, 0, 0}, 1, {4, 4, 8}, 0}, {{0, 0, 0}, 0, {4, 4, 0}, 1}, {{0, 0, 8}, 1, {1, 1, 8}, 1}},
                  {{0, 0}, {0, 1}}};
    tracer_.tree = build_late_split(bvh, geometry_clipper(geometries_), {.sa_max = 16});
    tracer_.geometries = geometries_;
  }

  TraceCounts counts_of(const Ray& ray, bool restores, uint32_t primitive) {
    tracer_.restores = restores;
    TraceCounts counts;
    EXPECT_EQ(late_split_table().closest_counted(&tracer_, ray, counts).primitive, primitive);
    EXPECT_EQ(late_split_table().closest(&tracer_, ray).primitive, primitive);
    EXPECT_EQ(late_split_table().any(&tracer_, ray), primitive != kNone);
    return counts;
  }

  std::vector<Vec3f> vertices_ = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 0, 8}, {1, 0, 8}, {0, 1, 8}};
  std::vector<TriangleCorners> triangles_ = {{0, 1, 2}, {3, 4, 5}};
  Geometry geometry_{TriangleMesh{vertices_, triangles_}};
  std::span<const Geometry> geometries_{&geometry_, 1};
  LateSplitTracer tracer_;
};

TEST_F(TwoLeaves, AreCutAsByHand) {
  using Node = LateSplitNode;
  const LateSplitBvh& tree = tracer_.tree;
  EXPECT_EQ(find_fault(tree, geometries_), std::nullopt);
  EXPECT_EQ(tree.root, (Node{{0, 0, 0}, 0, {4, 4, 8}, Node::kInner}));
  ASSERT_EQ(tree.pairs.size(), 2U);
  EXPECT_EQ(tree.pairs[0].child[0], (Node{{0, 0, 0}, 1, {4, 4, 0}, Node::kCutLeaf}));
  EXPECT_EQ(tree.pairs[0].child[1], (Node{{0, 0, 8}, 1, {1, 1, 8}, Node::kWholeLeaf}));
  EXPECT_EQ(tree.pairs[1].child[0], (Node{{0, 0, 0}, 0, {2, next_above(2), 0}, Node::kPiece}));
  EXPECT_EQ(tree.pairs[1].child[1], (Node{{2, 0, 0}, 0, {4, 4, 0}, Node::kPiece}));
  EXPECT_EQ(tree.slots, (std::vector<LeafSlot>{{0, 0}, {0, 1}}));
}

TEST_F(TwoLeaves, AreCountedAsByHand) {
  // Up through A2 alone: root, A, A2. Boxes: the root, A and B, A1 and A2.
  const Ray up{.origin = {3.5F, 1, -1}, .direction = {0, 0, 1}};
  for (const bool restores : {false, true}) {
    const TraceCounts counts = counts_of(up, restores, 0);
    EXPECT_EQ(counts.nodes, 3U);
    EXPECT_EQ(counts.primitives, 1U);
    EXPECT_EQ(counts.boxes, 5U);
  }
  // Through the side where the pieces meet, so both boxes are entered: the hit is tested for twice, or once.
  const Ray both{.origin = {1, 1.5F, -1}, .direction = {1, 0, 1}};
  EXPECT_EQ(counts_of(both, false, 0).primitives, 2U);
  EXPECT_EQ(counts_of(both, true, 0).primitives, 1U);
}

TEST_F(TwoLeaves, APrimitiveIsTestedOnceWhereTheStackIsRestored) {
  // In the plane of A, above the edge y = x all along but inside both boxes: a miss, for a triangle has no thickness.
  const Ray along{.origin = {-1, 1.5F, 0}, .direction = {1, 0, 0}};
  const TraceCounts plain = counts_of(along, false, kNone), restored = counts_of(along, true, kNone);
  EXPECT_EQ(plain.nodes, 4U);
  EXPECT_EQ(plain.primitives, 2U);
  EXPECT_EQ(restored.nodes, 3U);
  EXPECT_EQ(restored.primitives, 1U);
  EXPECT_EQ(restored.boxes, plain.boxes);
}

TEST_F(TwoLeaves, AWholeLeafAfterACutOneDoesNotRestore) {
  // Down: B first, a miss, which must not throw away the A that waits.
  const Ray down{.origin = {0.8F, 0.6F, 9}, .direction = {0, 0, -1}};
  const TraceCounts counts = counts_of(down, true, 0);
  EXPECT_EQ(counts.primitives, 2U);
  EXPECT_EQ(counts.nodes, 4U);
}

TEST_F(TwoLeaves, FaultsAreFound) {
  using Node = LateSplitNode;
  const auto fault_after = [&](auto&& damage) {
    LateSplitBvh tree = tracer_.tree;
    damage(tree);
    return find_fault(tree, geometries_);
  };
  EXPECT_EQ(fault_after([](LateSplitBvh&) {}), std::nullopt);
  EXPECT_NE(fault_after([](LateSplitBvh& t) { t.root.upper.x = 3; }), std::nullopt);
  EXPECT_NE(fault_after([](LateSplitBvh& t) { t.pairs[1].child[1].upper.x = 5; }), std::nullopt);
  EXPECT_NE(fault_after([](LateSplitBvh& t) { t.pairs[1].child[0].lower.x = 3; }), std::nullopt);
  EXPECT_NE(fault_after([](LateSplitBvh& t) { t.pairs[1].child[0].first = 1; }), std::nullopt);
  EXPECT_NE(fault_after([](LateSplitBvh& t) { t.pairs[1].child[0].first = 2; }), std::nullopt);
  EXPECT_NE(fault_after([](LateSplitBvh& t) { t.pairs[0].child[0].kind = Node::kInner; }), std::nullopt);
  EXPECT_NE(fault_after([](LateSplitBvh& t) { t.pairs[1].child[0].kind = Node::kWholeLeaf; }), std::nullopt);
  EXPECT_NE(fault_after([](LateSplitBvh& t) { t.pairs[0].child[1].kind = Node::kPiece; }), std::nullopt);
  EXPECT_NE(fault_after([](LateSplitBvh& t) { t.pairs[0].child[0].first = 0; }), std::nullopt);
  EXPECT_NE(fault_after([](LateSplitBvh& t) { t.pairs[0].child[1].first = 0; }), std::nullopt);
  EXPECT_NE(fault_after([](LateSplitBvh& t) { t.pairs.push_back(t.pairs[1]); }), std::nullopt);
  EXPECT_NE(fault_after([](LateSplitBvh& t) { t.slots.push_back({0, 0}); }), std::nullopt);
  EXPECT_NE(fault_after([](LateSplitBvh& t) { t.slots[0].primitive = 2; }), std::nullopt);
  EXPECT_NE(fault_after([](LateSplitBvh& t) { t.slots[0].geometry_bits = 1; }), std::nullopt);
  EXPECT_NE(fault_after([](LateSplitBvh& t) { t.slots.clear(); }), std::nullopt);
}

Scene scene_of(const RandomTriangles& triangles, const std::string& structure) {
  Scene scene;
  scene.add(triangles.geometry());
  scene.build({.structure = structure});
  return scene;
}

TEST(LateSplit, KeepsItsLimitsAndTheStandardTree) {
  const RandomTriangles triangles(3000);
  const BuildReport plain = scene_of(triangles, "binned_sah(leaf=1)").report();
  const BuildReport uncut = scene_of(triangles, "binned_sah+late_split").report();
  EXPECT_EQ(uncut.nodes, plain.nodes);
  EXPECT_EQ(uncut.sah_cost, plain.sah_cost);
  const Scene cut = scene_of(triangles, "binned_sah+late_split(sa_max=0.5,cap=1000)");
  EXPECT_GT(cut.report().references, 2 * uncut.references);
  cut.structure().visit_nodes(
      [](const NodeView& node) { EXPECT_TRUE(!node.is_leaf || surface_area(node.bounds) <= 0.5); });
  const double ratio = scene_of(triangles, "binned_sah+late_split(budget=3)").report().references_per_primitive;
  EXPECT_LE(ratio, 3);
  EXPECT_GT(ratio, 2.95);
  EXPECT_LE(scene_of(triangles, "binned_sah+late_split(sa_max=1e-9,cap=2)").report().references_per_primitive, 2);
}

TEST(LateSplit, OnePrimitiveIsTestedOnceHoweverDeepItsPieces) {
  const std::vector<Vec3f> vertices = {{0, 0, 0}, {10, 1, 0}, {1, 10, 9}};
  const std::vector<TriangleCorners> triangles = {{0, 1, 2}};
  size_t saved = 0;
  for (const bool restores : {true, false}) {
    Scene scene;
    scene.add(TriangleMesh{vertices, triangles});
    scene.build(
        {.structure = std::string("binned_sah+late_split(sa_max=1,cap=1000,restore=") + (restores ? "on)" : "off)")});
    EXPECT_GT(scene.report().depth, 6U);
    for (int i = 0; i < 400; ++i) {
      const int row = i / 20;
      const float x = 0.5F * static_cast<float>(i % 20), z = 0.5F * static_cast<float>(row);
      TraceCounts counts;
      scene.closest_hit({.origin = {x, -1, z}, .direction = {0.1F, 1, 0.1F}}, counts);
      if (restores) {
        EXPECT_LE(counts.primitives, 1U);
      } else {
        saved += counts.primitives > 1 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(saved, 20U) << "or there was nothing to save";
}

TEST(LateSplit, MayFollowEarlySplitting) {
  const RandomTriangles triangles(500);
  const Scene scene = scene_of(triangles, "early_split(budget=2)+binned_sah+late_split(budget=2)");
  EXPECT_EQ(scene.structure().find_fault(), std::nullopt);
  EXPECT_GT(scene.report().references_per_primitive, 3.9);
}

TEST(LateSplit, ATreeAsDeepAsAllowedIsNotCutAndShallowerOnesOnlySoFar) {
  // A list of kMaxDepth + 1 leaves, one for each level, all of the same large triangle.
  const std::vector<Vec3f> vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0.5F}};
  const std::vector<TriangleCorners> corners(kMaxDepth + 1, {0, 1, 2});
  const Geometry geometry{TriangleMesh{vertices, corners}};
  const std::span<const Geometry> geometries(&geometry, 1);
  const Box3f box = primitive_bounds(geometry, 0);
  Bvh bvh;
  bvh.nodes.push_back({box.lower, 1, box.upper, 0});
  for (uint32_t level = 0; level < kMaxDepth; ++level) {
    bvh.nodes.push_back({box.lower, level, box.upper, 1});
    const bool is_last = level + 1 == kMaxDepth;
    bvh.nodes.push_back({box.lower, is_last ? kMaxDepth : 2 * level + 3, box.upper, is_last ? 1U : 0U});
  }
  for (uint32_t i = 0; i <= kMaxDepth; ++i) bvh.slots.push_back({0, i});
  ASSERT_EQ(find_fault(bvh, geometries, 1), std::nullopt);
  const LateSplitBvh tree = build_late_split(bvh, geometry_clipper(geometries), {.sa_max = 0.05, .cap = 1000});
  EXPECT_EQ(find_fault(tree, geometries), std::nullopt);
  EXPECT_EQ(tree.pairs[kMaxDepth - 1].child[1].kind, LateSplitNode::kWholeLeaf);
  EXPECT_EQ(tree.pairs[0].child[0].kind, LateSplitNode::kCutLeaf);
}

TEST(LateSplit, RefusesWhatCannotBeMeant) {
  const RandomTriangles triangles(5);
  const auto text_of = [&](const std::string& structure) {
    return error_of(ErrorCode::invalid_option, [&] { scene_of(triangles, structure); });
  };
  EXPECT_NE(text_of("binned_sah+late_split(budget=2,cap=3)").find("one or the other"), std::string::npos);
  EXPECT_NE(text_of("binned_sah(leaf=2)+late_split").find("leaves of at most 1"), std::string::npos);
  EXPECT_NE(text_of("binned_sah+late_split(sa_max=0)"), "");
  EXPECT_NE(text_of("late_split+binned_sah"), "");
}

TEST(LateSplit, GivesUpAtItsLimit) {
  const RandomTriangles triangles(2000);
  const std::vector<Geometry> geometries{triangles.geometry()};
  const std::span<const Geometry> all = geometries;
  OptionValues options(TopDownOptions::kSpecs);
  options.set("object_median", "leaf", 1);
  const Bvh bvh = build_object_median(make_references(all).references, options);
  const std::atomic<bool> cancelled = true;
  WorkLimit unwanted, late, small, tiny;
  unwanted.cancelled = &cancelled;
  late.deadline = WorkLimit::Clock::now();
  small.bytes = 2 * bvh.bytes();  // enough for the tree, not for the pieces
  tiny.bytes = 1000;
  for (const EarlySplit& how : {EarlySplit::with_budget(16), EarlySplit{1e-3, 1000}}) {
    for (const WorkLimit& limit : {unwanted, late, small, tiny}) {
      error_of(ErrorCode::stopped, [&] { build_late_split(bvh, geometry_clipper(all), how, limit); });
    }
  }
  error_of(ErrorCode::stopped, [&] { build_late_split(bvh, geometry_clipper(all), {}, tiny); });
  EXPECT_FALSE(build_late_split(bvh, geometry_clipper(all), EarlySplit::with_budget(1.2), small).is_empty());
}

}  // namespace
}  // namespace kerf::test
