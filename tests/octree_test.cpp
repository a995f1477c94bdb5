// The octree and the quadtree: traversal on trees worked by hand, which cells a primitive gets, the bounds of the
// build, the check of invariants.

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "kerf/build/octree.h"
#include "kerf/trace/mailbox.h"
#include "kerf/trace/trace_octree.h"
#include "kerf/tree/cell_slots.h"
#include "tests/support/error_of.h"
#include "tests/support/four_plates.h"
#include "tests/support/random_scene.h"

namespace kerf::test {
namespace {

/// Divided twice along x only, the plates in a leaf each, nothing above y = 1 or z = 1:
///
///              0 [0,4]
///        1 [0,2]      2 [2,4]
///     3 [0,1] 4 [1,2] 5 [2,3] 6 [3,4]
Octree seven_cells() {
  Octree tree;
  tree.bounds = {{0, 0, 0}, {4, 4, 4}};
  const auto leaf = [](uint32_t slot) { return OctreeNode{slot, 1}; };
  tree.nodes = {{1, OctreeNode::kInner | 3},
                {3, OctreeNode::kInner | 3},
                {5, OctreeNode::kInner | 3},
                leaf(0),
                leaf(1),
                leaf(2),
                leaf(3)};
  for (uint32_t i = 0; i < 4; ++i) tree.slots.push_back({0, i});
  return tree;
}

class SevenCells : public testing::Test {
 protected:
  SevenCells() : tracer_{seven_cells(), plates_.geometries()} {
    EXPECT_EQ(find_fault(tracer_.tree, plates_.geometries()), std::nullopt);
  }
  Outcome trace(const Ray& ray) const { return closest(octree_table(true), &tracer_, ray); }

  FourPlates plates_;
  OctreeTracer<Mailbox> tracer_;
};

TEST_F(SevenCells, NearCellsFirstAndCellsBehindTheHitAreSkipped) {
  const auto [hit, counts] = trace({.origin = {-1, 0.25F, 0.25F}, .direction = {1, 0, 0}});
  EXPECT_EQ(hit.primitive, 0U);
  EXPECT_EQ(hit.t, 1.5F);
  expect_counts(counts, 3, 1, 5);  // nodes 0, 1, 3; the boxes of 0, 1, 2, 3, 4
  const auto back = trace({.origin = {9, 0.25F, 0.25F}, .direction = {-2, 0, 0}});
  EXPECT_EQ(back.hit.primitive, 3U);
  expect_counts(back.counts, 3, 1, 5);  // nodes 0, 2, 6
}

TEST_F(SevenCells, ARayThroughAllCellsAndNoTriangleVisitsAll) {
  const auto [hit, counts] = trace({.origin = {-1, 0.75F, 0.75F}, .direction = {1, 0, 0}});
  EXPECT_FALSE(hit);
  expect_counts(counts, 7, 4, 7);
  expect_counts(trace({.origin = {-1, 5, 0.25F}, .direction = {1, 0, 0}}).counts, 0, 0, 1);
}

TEST_F(SevenCells, WhatIsEmptyCostsNothing) {
  // Through the root's upper half along y only: no child is there, and none is tested.
  expect_counts(trace({.origin = {-1, 3, 0.25F}, .direction = {1, 0, 0}}).counts, 1, 0, 1);
  // Through the empty parts of nodes 1 and 2.
  expect_counts(trace({.origin = {-1, 1.5F, 0.25F}, .direction = {1, 0, 0}}).counts, 3, 0, 3);
}

TEST_F(SevenCells, TheIntervalCullsCellsAtBothEnds) {
  const Vec3f origin{-1, 0.25F, 0.25F}, x{1, 0, 0};
  const auto third = trace({.origin = origin, .t_min = 3.25F, .direction = x});
  EXPECT_EQ(third.hit.primitive, 2U);
  expect_counts(third.counts, 3, 1, 4);  // the first half is ruled out without a test
  const auto none = trace({.origin = origin, .t_min = 1.75F, .direction = x, .t_max = 1.9F});
  EXPECT_FALSE(none.hit);
  expect_counts(none.counts, 3, 1, 3);  // nodes 0, 1, 3
}

TEST_F(SevenCells, ARayInAPlaneVisitsBothSides) {
  const auto [hit, counts] = trace({.origin = {2, 3, 0.25F}, .direction = {0, -1, 0}});
  EXPECT_FALSE(hit);
  expect_counts(counts, 5, 2, 5);  // nodes 0, 1, 2, 4, 5
}

Octree build(const std::vector<Geometry>& geometries, const OctreeOptions& options, const WorkLimit& limit = {}) {
  const std::span<const Geometry> all = geometries;
  Octree tree = build_octree(make_references(all).references, geometry_clipper(all), options, limit);
  mark_repeated(tree.slots, all);
  return tree;
}

TEST(Octree, APrimitiveInManyLeavesIsTestedOnce) {
  const FourPlates plates(true);
  const Octree tree = build({plates.geometry}, {.leaf_size = 1, .max_depth = 3});
  ASSERT_EQ(find_fault(tree, plates.geometries()), std::nullopt);
  const OctreeTracer<Mailbox> once{tree, plates.geometries()};
  const OctreeTracer<NoMailbox> again{tree, plates.geometries()};
  const Ray along{.origin = {-1, -0.99F, 0.01F}, .direction = {1, 0, 0}};
  EXPECT_EQ(closest(octree_table(true), &once, along).counts.primitives, 1U);
  EXPECT_GT(closest(octree_table(false), &again, along).counts.primitives, 1U);
}

TEST(Octree, AQuadtreeLeavesOneAxisWhole) {
  const RandomTriangles triangles(500);
  const std::vector<Geometry> geometries{triangles.geometry()};
  for (int axis = 0; axis < 3; ++axis) {
    const Octree tree = build(geometries, {.undivided = axis});
    EXPECT_EQ(find_fault(tree, geometries), std::nullopt);
    EXPECT_GT(tree.nodes.size(), 50U);
    const uint32_t upper_halves[] = {0xAA, 0xCC, 0xF0};
    for (const OctreeNode& node : tree.nodes) {
      EXPECT_TRUE(node.is_leaf() || (node.octants() & upper_halves[axis]) == 0);
    }
  }
}

TEST(Octree, TheShortestAxisIsThatOfTheWholeBox) {
  const std::vector<Reference> references{{{0, 0, 0}, 0, {1, 1, 1}, 0}, {{4, 1, 0}, 0, {5, 2, 8}, 1}};
  EXPECT_EQ(shortest_axis(references), kY);
}

TEST(Octree, TheCapAndTheDepthBoundTheBuild) {
  const RandomTriangles triangles(3000, 5, 1);
  const std::vector<Geometry> geometries{triangles.geometry()};
  size_t last = 0;
  for (const double cap : {1.0, 2.0, 4.0, 16.0}) {
    const Octree tree = build(geometries, {.leaf_size = 1, .cap = cap});
    EXPECT_LE(static_cast<double>(tree.slots.size()), cap * 3000);
    EXPECT_GT(tree.slots.size(), last);
    EXPECT_EQ(find_fault(tree, geometries), std::nullopt);
    last = tree.slots.size();
  }
  EXPECT_LE(build(geometries, {.leaf_size = 1, .max_depth = 2}).nodes.size(), 1U + 8 + 64);
}

TEST(Octree, AClusterOfDenormalSizeIsDividedToTheLastFloat) {
  std::vector<Vec3f> vertices;
  std::vector<TriangleCorners> corners;
  for (uint32_t i = 0; i < 32; ++i) {
    const float x = 1e-44F * static_cast<float>(i);
    vertices.insert(vertices.end(), {{x, 0, 0}, {x, 1e-44F, 0}, {x, 0, 1e-44F}});
    corners.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  vertices.push_back({1, 1, 1});
  corners.push_back({0, 1, 96});
  const std::vector<Geometry> geometries{{TriangleMesh{vertices, corners}}};
  for (const bool cube : {false, true}) {
    const Octree tree = build(geometries, {.leaf_size = 1, .max_depth = kMaxDepth, .cap = 64, .cube = cube});
    EXPECT_EQ(find_fault(tree, geometries), std::nullopt);
  }
}

/// In a cube each octant has a triangle, and the first one is divided likewise, `levels` times.
struct NestedCorners {
  std::vector<Vec3f> vertices;
  std::vector<TriangleCorners> triangles;

  explicit NestedCorners(uint32_t levels) {
    float side = 1;
    for (uint32_t level = 0; level < levels; ++level) {
      side *= 0.5F;
      for (uint32_t octant = 1; octant < 8; ++octant) add(octant, side);
    }
    add(0, side);
    add_triangle({0, 0, 0}, {0.25F * side, 0, 0}, {0, 0.25F * side, 0});  // the cube's corners
    add_triangle({1, 1, 1}, {0.9375F, 1, 1}, {1, 0.9375F, 1});
  }
  Geometry geometry() const { return {TriangleMesh{std::span(vertices), std::span(triangles)}}; }

 private:
  void add(uint32_t octant, float side) {
    const auto half = [&](uint32_t axis) { return (octant >> axis & 1) != 0 ? side : 0.0F; };
    const Vec3f at{half(0), half(1), half(2)};
    add_triangle(at + side * Vec3f{0.5F, 0.25F, 0.25F}, at + side * Vec3f{0.75F, 0.25F, 0.5F},
                 at + side * Vec3f{0.5F, 0.25F, 0.75F});
  }
  void add_triangle(Vec3f a, Vec3f b, Vec3f c) {
    const auto first = static_cast<uint32_t>(vertices.size());
    vertices.insert(vertices.end(), {a, b, c});
    triangles.push_back({first, first + 1, first + 2});
  }
};

TEST(Octree, AsManyCellsWaitAsEver) {
  // Along the diagonal all octants of each cell are reached, the divided one first, and nothing is hit but at the end.
  const NestedCorners corners(kMaxDepth);
  const std::vector<Geometry> geometries{corners.geometry()};
  const Octree tree = build(geometries, {.leaf_size = 1, .max_depth = kMaxDepth, .cap = 64});
  ASSERT_EQ(find_fault(tree, geometries), std::nullopt);
  uint32_t depth = 0;
  for (uint32_t node = 0; !tree.nodes[node].is_leaf(); ++depth) node = tree.nodes[node].first;
  EXPECT_EQ(depth, kMaxDepth);
  const OctreeTracer<Mailbox> tracer{tree, geometries};
  const OctreeTracer<Mailbox> shallow{build(geometries, {.max_depth = 1}), geometries};
  for (const float start : {0.0F, -0.5F, -1.0F}) {
    const Ray ray{.origin = {start, start, start}, .direction = {1, 1, 1}};
    const auto [hit, counts] = closest(octree_table(true), &tracer, ray);
    EXPECT_EQ(hit, closest(octree_table(true), &shallow, ray).hit);
    EXPECT_GE(counts.boxes, 1 + 8 * kMaxDepth);
  }
}

TEST(Octree, GivesUpAtItsMemoryLimit) {
  const RandomTriangles triangles(3000);
  WorkLimit limit;
  const OctreeOptions options{.leaf_size = 1};
  const size_t least = 3000 * sizeof(Reference);
  const Octree tree = build({triangles.geometry()}, options);
  for (const size_t bytes : {size_t{1000}, least, tree.bytes()}) {
    limit.bytes = bytes;
    error_of(ErrorCode::stopped, [&] { build({triangles.geometry()}, options, limit); });
  }
  // What the cap would allow is not asked for in advance.
  limit.bytes = 40 * tree.bytes();
  for (const double cap : {1e6, 1e300, std::numeric_limits<double>::infinity()}) {
    const Octree capped = build({triangles.geometry()}, {.leaf_size = 100, .cap = cap}, limit);
    EXPECT_EQ(find_fault(capped, std::vector{triangles.geometry()}), std::nullopt);
  }
}

TEST(Octree, FaultsAreFound) {
  const RandomTriangles triangles(200);
  const std::vector<Geometry> geometries{triangles.geometry()};
  const Octree good = build(geometries, {.leaf_size = 2});
  ASSERT_EQ(find_fault(good, geometries), std::nullopt);
  ASSERT_FALSE(good.nodes[0].is_leaf());
  EXPECT_EQ(find_fault(Octree{}, {}), std::nullopt);
  const auto leaf = [](Octree& t) -> OctreeNode& {
    for (OctreeNode& node : t.nodes) {
      if (node.is_leaf() && node.bits > 1) return node;
    }
    return t.nodes.back();
  };
  const std::pair<const char*, std::function<void(Octree&)>> faults[] = {
      {"no primitive", [](Octree& t) { t.slots[3].primitive = 200; }},
      {"repeat mark", [](Octree& t) { t.slots[3].geometry_bits ^= LeafSlot::kRepeated; }},
      {"children elsewhere", [](Octree& t) { t.nodes[0].first = static_cast<uint32_t>(t.nodes.size()) - 1; }},
      {"children elsewhere", [](Octree& t) { t.nodes[0].first = 0; }},
      {"no children", [](Octree& t) { t.nodes[0].bits = OctreeNode::kInner; }},
      {"not divided", [](Octree& t) { t.axes = 3; }},
      {"axes that do not exist", [](Octree& t) { t.axes = 9; }},
      {"is empty", [&](Octree& t) { leaf(t).bits = 0; }},
      {"slots out of range", [&](Octree& t) { leaf(t).first = static_cast<uint32_t>(t.slots.size()); }},
      {"slot in no leaf", [&](Octree& t) { --leaf(t).bits; }},
      {"out of order", [&](Octree& t) { std::swap(t.slots[leaf(t).first], t.slots[leaf(t).first + 1]); }},
      {"node nothing leads to", [](Octree& t) { t.nodes.push_back({}); }},
      {"", [](Octree& t) { t.bounds.upper.x += 10; }},
      {"out of the tree", [](Octree& t) { t.bounds.upper.x -= 1e-3F; }},
  };
  for (const auto& [what, damage] : faults) {
    Octree bad = good;
    damage(bad);
    const auto fault = find_fault(bad, geometries);
    ASSERT_TRUE(fault.has_value()) << what;
    EXPECT_NE(fault->find(what), std::string::npos) << *fault;
  }
}

TEST(Octree, APrimitiveMissingInALeafIsFound) {
  // The floor in one of its leaves less, where another primitive takes its place.
  const FourPlates plates(true);
  Octree tree = build({plates.geometry}, {.leaf_size = 1, .max_depth = 2});
  ASSERT_EQ(find_fault(tree, plates.geometries()), std::nullopt);
  for (size_t i = 0; i < tree.nodes.size(); ++i) {
    const OctreeNode& node = tree.nodes[i];
    if (!node.is_leaf() || node.bits != 1 || tree.slots[node.first].primitive != 4) continue;
    tree.slots[node.first].primitive = 1;
    mark_repeated(tree.slots, plates.geometries());
    EXPECT_NE(find_fault(tree, plates.geometries()), std::nullopt);
    return;
  }
  ADD_FAILURE() << "no such leaf";
}

}  // namespace
}  // namespace kerf::test
