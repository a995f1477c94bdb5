// The kd-tree and its traversal: a tree worked by hand, what find_fault() notices, and rays within planes.

#include "kerf/tree/kd_tree.h"

#include <gtest/gtest.h>

#include <functional>

#include "kerf/build/kd_builder.h"
#include "kerf/trace/trace_kd.h"
#include "tests/support/random_scene.h"

namespace kerf::test {
namespace {

/// Triangles across the x axis at x = 1, 2, 3 and 4 that cover y + z <= 1, and a long one along it, from x = 0 to 5 at
/// z = 0.5 and y <= 0.25, in a tree of seven nodes:
///
///                  0 x=2.5
///        1 x=1.5              4 x=3.5
///   2 [0,1.5]  3 [1.5,2.5]   5 [2.5,3.5]  6 [3.5,5]
class SevenCells : public testing::Test {
 protected:
  SevenCells() {
    for (uint32_t i = 0; i < 4; ++i) {
      const float x = static_cast<float>(i) + 1;
      vertices_.insert(vertices_.end(), {{x, 0, 0}, {x, 1, 0}, {x, 0, 1}});
      triangles_.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    vertices_.insert(vertices_.end(), {{0, 0, 0.5F}, {5, 0, 0.5F}, {5, 0.25F, 0.5F}});
    triangles_.push_back({12, 13, 14});
    geometry_ = {TriangleMesh{std::span<const Vec3f>(vertices_), std::span<const TriangleCorners>(triangles_)}};
    tree_.bounds = {{0, 0, 0}, {5, 1, 1}};
    tree_.nodes = {KdNode::inner(kX, 2.5F, 4), KdNode::inner(kX, 1.5F, 3), KdNode::leaf(0, 2), KdNode::leaf(2, 2),
                   KdNode::inner(kX, 3.5F, 6), KdNode::leaf(4, 2),         KdNode::leaf(6, 2)};
    for (uint32_t i = 0; i < 4; ++i) tree_.slots.insert(tree_.slots.end(), {{0, i}, {0, 4}});
    mark_repeated(tree_, geometries());
  }

  std::span<const Geometry> geometries() const { return {&geometry_, 1}; }

  struct Outcome {
    Hit hit;
    TraceCounts counts;
  };
  template <bool kMailbox = false>
  Outcome closest(const Ray& ray) const {
    const KdTracer<kMailbox> tracer{tree_, geometries()};
    Outcome outcome;
    outcome.hit = kd_table<kMailbox>().closest_counted(&tracer, ray, outcome.counts);
    EXPECT_EQ(kd_table<kMailbox>().closest(&tracer, ray), outcome.hit);
    EXPECT_EQ(kd_table<kMailbox>().any(&tracer, ray), static_cast<bool>(outcome.hit));
    return outcome;
  }

  std::vector<Vec3f> vertices_;
  std::vector<TriangleCorners> triangles_;
  Geometry geometry_;
  KdTree tree_;
};

void expect_counts(const TraceCounts& counts, uint64_t nodes, uint64_t primitives, uint64_t boxes) {
  EXPECT_EQ(counts.nodes, nodes);
  EXPECT_EQ(counts.primitives, primitives);
  EXPECT_EQ(counts.boxes, boxes);
}

TEST_F(SevenCells, IsWithoutFault) { EXPECT_EQ(find_fault(tree_, geometries()), std::nullopt); }

TEST_F(SevenCells, TheFirstLeafWithAHitInsideItEndsTheWalk) {
  const auto [hit, counts] = closest({.origin = {-1, 0.25F, 0.25F}, .direction = {1, 0, 0}});
  EXPECT_EQ(hit.primitive, 0U);
  EXPECT_EQ(hit.t, 2);
  expect_counts(counts, 3, 2, 1);  // nodes 0, 1, 2
}

TEST_F(SevenCells, TheOtherWayRoundTheUpperChildIsNear) {
  const auto [hit, counts] = closest({.origin = {9, 0.25F, 0.25F}, .direction = {-2, 0, 0}});
  EXPECT_EQ(hit.primitive, 3U);
  EXPECT_EQ(hit.t, 2.5F);
  expect_counts(counts, 3, 2, 1);  // nodes 0, 4, 6
}

TEST_F(SevenCells, ARayThroughAllCellsVisitsAllAndTheMailboxTestsEachOnce) {
  const Ray ray{.origin = {-1, 0.75F, 0.75F}, .direction = {1, 0, 0}};
  EXPECT_FALSE(closest(ray).hit);
  expect_counts(closest(ray).counts, 7, 8, 1);
  EXPECT_FALSE(closest<true>(ray).hit);
  expect_counts(closest<true>(ray).counts, 7, 5, 1);
}

TEST_F(SevenCells, AHitBeyondTheLeafDoesNotEndTheWalk) {
  // In the cell of node 5 it is tested against the long triangle, which it meets at x = 4.5, behind that at x = 4.
  const auto [hit, counts] = closest({.origin = {3.25F, 0.2F, 0.625F}, .direction = {1, 0, -0.1F}});
  EXPECT_EQ(hit.primitive, 3U);
  EXPECT_EQ(hit.t, 0.75F);
  expect_counts(counts, 4, 4, 1);  // nodes 0, 4, 5, 6
}

TEST_F(SevenCells, TheIntervalAndTheBoundsLimitTheWalk) {
  const Vec3f origin{0, 0.25F, 0.25F}, x{1, 0, 0};
  expect_counts(closest({.origin = {0, 2, 0.25F}, .direction = x}).counts, 0, 0, 1);
  const auto second = closest({.origin = origin, .t_min = 1.75F, .direction = x});
  EXPECT_EQ(second.hit.primitive, 1U);
  expect_counts(second.counts, 3, 2, 1);  // nodes 0, 1, 3
  const auto none = closest({.origin = origin, .t_min = 2.75F, .direction = x, .t_max = 2.875F});
  EXPECT_FALSE(none.hit);
  expect_counts(none.counts, 3, 2, 1);  // nodes 0, 4, 5
  EXPECT_EQ(closest({.origin = origin, .t_min = 2, .direction = x, .t_max = 2}).hit.primitive, 1U);
}

TEST_F(SevenCells, RaysWithinAPlaneVisitBothSides) {
  for (const float zero : {0.0F, -0.0F}) {
    const auto [hit, counts] = closest({.origin = {2.5F, -1, 0.25F}, .direction = {zero, 1, zero}});
    EXPECT_FALSE(hit);
    expect_counts(counts, 5, 4, 1);  // nodes 0, 1, 3, 4, 5
  }
}

TEST_F(SevenCells, AnEmptyTreeHitsNothing) {
  tree_ = {};
  EXPECT_FALSE(closest({.origin = {0, 0, 0}, .direction = {1, 0, 0}}).hit);
  EXPECT_EQ(find_fault(tree_, geometries()), std::nullopt);
}

TEST_F(SevenCells, EveryDamageIsNoticed) {
  const std::pair<const char*, std::function<void(KdTree&)>> damages[] = {
      {"plane outside", [](KdTree& t) { t.nodes[1] = KdNode::inner(kX, 2.75F, 3); }},
      {"plane on a side", [](KdTree& t) { t.nodes[1] = KdNode::inner(kY, 1, 3); }},
      {"plane moved", [](KdTree& t) { t.nodes[1] = KdNode::inner(kX, 0.5F, 3); }},
      {"another axis", [](KdTree& t) { t.nodes[4] = KdNode::inner(kY, 0.5F, 6); }},
      {"a child skipped", [](KdTree& t) { t.nodes[0] = KdNode::inner(kX, 2.5F, 5); }},
      {"a child reached twice", [](KdTree& t) { t.nodes[4] = KdNode::inner(kX, 3.5F, 5); }},
      {"a link out of range", [](KdTree& t) { t.nodes[4] = KdNode::inner(kX, 3.5F, 99); }},
      {"a link back", [](KdTree& t) { t.nodes[4] = KdNode::inner(kX, 3.5F, 0); }},
      {"nodes cut short", [](KdTree& t) { t.nodes.pop_back(); }},
      {"a node too many", [](KdTree& t) { t.nodes.push_back(KdNode::leaf(8, 0)); }},
      {"slots out of order", [](KdTree& t) { std::swap(t.nodes[2], t.nodes[3]); }},
      {"slots out of range", [](KdTree& t) { t.nodes[6] = KdNode::leaf(6, 3); }},
      {"a slot in no leaf", [](KdTree& t) { t.nodes[6] = KdNode::leaf(6, 1); }},
      {"a slot too many",
       [](KdTree& t) {
         t.slots.push_back({LeafSlot::kRepeated, 4});
       }},
      {"a wrong primitive", [](KdTree& t) { t.slots[0].primitive = 1; }},
      {"no such primitive", [](KdTree& t) { t.slots[0].primitive = 5; }},
      {"no such geometry", [](KdTree& t) { t.slots[0].geometry_bits = 1; }},
      {"twice in a leaf", [](KdTree& t) { t.slots[0].primitive = 4; }},
      {"repeat mark gone", [](KdTree& t) { t.slots[1].geometry_bits = 0; }},
      {"repeat mark too many", [](KdTree& t) { t.slots[0].geometry_bits = LeafSlot::kRepeated; }},
  };
  for (const auto& [name, damage] : damages) {
    KdTree damaged = tree_;
    damage(damaged);
    EXPECT_NE(find_fault(damaged, geometries()), std::nullopt) << name;
    EXPECT_NE(tree_hash(damaged), tree_hash(tree_)) << name;
  }
  EXPECT_NE(find_fault(tree_, geometries(), false, 1), std::nullopt) << "too deep";
}

TEST_F(SevenCells, APrimitiveMissingFromOneOfItsLeavesIsNoticed) {
  for (const uint32_t slot : {1U, 3U, 5U, 7U}) {
    KdTree tree = tree_;
    tree.slots.erase(tree.slots.begin() + slot);
    for (KdNode& node : tree.nodes) {
      if (!node.is_leaf() || node.first() + node.count() <= slot) continue;
      node = node.first() > slot ? KdNode::leaf(node.first() - 1, node.count()) : KdNode::leaf(node.first(), 1);
    }
    const auto fault = find_fault(tree, geometries());
    ASSERT_TRUE(fault) << slot;
    EXPECT_NE(fault->find("lacks primitive 4"), std::string::npos) << *fault;
  }
}

TEST(KdTree, DamageToBuiltTreesIsNoticed) {
  const RandomTriangles triangles(300, 3);
  const Geometry geometry = triangles.geometry();
  const std::span<const Geometry> geometries(&geometry, 1);
  KdTree tree = build_kd_tree(make_references(geometries).references, geometry_clipper(geometries), {});
  mark_repeated(tree, geometries);
  EXPECT_EQ(find_fault(tree, geometries), std::nullopt);
  for (uint32_t number = 0; number < tree.nodes.size(); number += 7) {
    KdTree damaged = tree;
    KdNode& node = damaged.nodes[number];
    if (node.is_leaf() && node.count() == 0) continue;
    node = node.is_leaf() ? KdNode::leaf(node.first(), node.count() - 1)
                          : KdNode::inner((node.axis() + 1) % 3, node.plane(), node.above());
    EXPECT_NE(find_fault(damaged, geometries), std::nullopt) << number;
  }
}

}  // namespace
}  // namespace kerf::test
