// The trees of the wide layouts: the collapse worked by hand and against a greedy one, damage that is found, and
// bounds.

#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "kerf/base/parallel.h"
#include "kerf/layout/wide_bvh.h"
#include "kerf/layout/wide_collapse.h"
#include "kerf/scene/scene.h"
#include "kerf/trace/trace_wide.h"
#include "tests/support/error_of.h"
#include "tests/support/hand_tree.h"
#include "tests/support/moving_things.h"
#include "tests/support/random_scene.h"
#include "tests/support/sizes.h"
#include "tests/support/wide_trees.h"

namespace kerf::test {
namespace {

/// What the layout's nodes and leaves cost together by the same model.
template <uint32_t kWidth>
double cost_of(const WideBvh<kWidth>& layout, WideChild child, const Box3f& box, const WideCosts& costs) {
  const double area = half_area(box) / half_area(layout.bounds);
  if (child.kind() == WideChild::kSlots) {
    return area * costs.primitive * static_cast<double>(layout.slots(child).size());
  }
  if (child.is_leaf()) return area * (costs.leaf + costs.triangle * child.kind());
  double sum = area * costs.node;
  const WideNode<kWidth>& node = layout.nodes[child.number()];
  for (uint32_t i = 0; i < kWidth && node.has_child(i); ++i)
    sum += cost_of(layout, node.child[i], node.bounds(i), costs);
  return sum;
}

/// Of a tree collapsed by opening the largest child again and again, the leaves as the builder made them.
double greedy_cost(const Bvh& bvh, uint32_t number, uint32_t width, const WideCosts& costs) {
  const auto area = [&](uint32_t n) { return half_area(bvh.nodes[n].bounds()) / half_area(bvh.nodes[0].bounds()); };
  const BvhNode& node = bvh.nodes[number];
  if (node.is_leaf()) return area(number) * (costs.leaf + costs.triangle * node.count);
  std::vector<uint32_t> children{node.first, node.first + 1};
  while (children.size() < width) {
    size_t largest = children.size();
    for (size_t i = 0; i < children.size(); ++i) {
      const bool is_inner = !bvh.nodes[children[i]].is_leaf();
      if (is_inner && (largest == children.size() || area(children[i]) > area(children[largest]))) largest = i;
    }
    if (largest == children.size()) break;
    const uint32_t first = bvh.nodes[children[largest]].first;
    children[largest] = first;
    children.push_back(first + 1);
  }
  double sum = area(number) * costs.node;
  for (const uint32_t child : children) sum += greedy_cost(bvh, child, width, costs);
  return sum;
}

TEST(WideCollapse, TheHandTree) {
  // Half areas: 7 for the root, 3 for each of its children, 1 for each leaf.
  const SevenNodes hand;
  const Bvh bvh = SevenNodes::bvh();
  const auto collapse = [&](uint32_t width, double triangle) {
    WideCosts costs;
    costs.triangle = triangle;
    return WideCollapse(bvh, hand.scene.geometries(), width, costs);
  };
  const WideCollapse one_leaf = collapse(8, 0.1);
  EXPECT_TRUE(one_leaf.is_leaf(0));
  EXPECT_NEAR(one_leaf.cost(), 0.7 + 4 * 0.1, 1e-6);
  EXPECT_EQ(one_leaf.size(0).nodes, 0U);
  EXPECT_EQ(one_leaf.size(0).units, TriangleLeaf::units(4));
  // Triangles that are dear stand alone, and only the root is a node if it may have four children.
  WideCollapse::Children children;
  const WideCollapse two = collapse(2, 1), three = collapse(3, 1), four = collapse(4, 1), eight = collapse(8, 1);
  EXPECT_NEAR(two.cost(), (7 + 3 + 3 + 4 * 1.7) / 7, 1e-6);
  EXPECT_NEAR(three.cost(), (7 + 3 + 4 * 1.7) / 7, 1e-6);
  EXPECT_NEAR(four.cost(), (7 + 4 * 1.7) / 7, 1e-6);
  EXPECT_EQ(eight.cost(), four.cost());
  EXPECT_EQ(two.size(0).nodes, 3U);
  EXPECT_EQ(three.size(0).nodes, 2U);
  EXPECT_EQ(four.size(0).nodes, 1U);
  EXPECT_EQ(four.size(0).units, 4 * TriangleLeaf::units(1));
  ASSERT_EQ(four.children(0, children), 4U);
  EXPECT_EQ(children[0] + children[1] + children[2] + children[3], 3U + 4 + 5 + 6);
  ASSERT_EQ(three.children(0, children), 3U);
  EXPECT_LE(children[0], 2U) << "the largest first";
}

TEST(WideCollapse, NeverCostsMoreThanOpeningTheLargestChild) {
  for (const uint32_t seed : {1U, 2U, 3U}) {
    const RandomTriangles triangles(2000, seed);
    const Geometry geometry = triangles.geometry();
    const Bvh bvh = lbvh_tree({&geometry, 1});
    for (const double triangle : {0.0, 0.1, 0.5, 2.0}) {
      WideCosts costs;
      costs.triangle = triangle;
      const double four = WideCollapse(bvh, {&geometry, 1}, 4, costs).cost();
      const double eight = WideCollapse(bvh, {&geometry, 1}, 8, costs).cost();
      EXPECT_LE(four, greedy_cost(bvh, 0, 4, costs) * (1 + 1e-5));
      EXPECT_LE(eight, greedy_cost(bvh, 0, 8, costs) * (1 + 1e-5));
      EXPECT_LT(eight, four);
      const auto layout4 = make_wide_bvh<4>(bvh, {&geometry, 1}, costs);
      const auto layout8 = make_wide_bvh<8>(bvh, {&geometry, 1}, costs);
      EXPECT_NEAR(cost_of(layout4, layout4.root, layout4.bounds, costs), four, 1e-4 * four);
      EXPECT_NEAR(cost_of(layout8, layout8.root, layout8.bounds, costs), eight, 1e-4 * eight);
    }
  }
}

TEST(WideCollapse, WhatHasNoAreaMakesFewNodes) {
  // A chain of boxes that are all one point; each primitive a leaf, as spheres are.
  const std::vector<Sphere> spheres(40, Sphere{{1, 2, 3}, 0});
  const Geometry geometry{Strided<Sphere>(spheres.data(), spheres.size())};
  Bvh bvh;
  const Box3f point{{1, 2, 3}, {1, 2, 3}};
  for (uint32_t i = 0; i < 40; ++i) bvh.slots.push_back({0, i});
  bvh.nodes.push_back({point.lower, 1, point.upper, 0});
  for (uint32_t i = 0; i < 39; ++i) {
    bvh.nodes.push_back({point.lower, i, point.upper, 1});
    bvh.nodes.push_back(i < 38 ? BvhNode{point.lower, 2 * i + 3, point.upper, 0}
                               : BvhNode{point.lower, 39, point.upper, 1});
  }
  ASSERT_EQ(find_fault(bvh, {&geometry, 1}, 1), std::nullopt);
  const WideCollapse collapse(bvh, {&geometry, 1}, 8, {});
  EXPECT_EQ(collapse.cost(), 0);
  EXPECT_EQ(collapse.size(0).nodes, 6U) << "7 more primitives in each";
  EXPECT_EQ(find_fault(make_wide_bvh<8>(bvh, {&geometry, 1}), {&geometry, 1}), std::nullopt);
}

TEST(WideCollapse, WhatIsTooLargeForItsNumbersIsAnError) {
  const RandomTriangles triangles(500);
  const Geometry geometry = triangles.geometry();
  const Bvh bvh = lbvh_tree({&geometry, 1});
  const uint32_t units = WideCollapse(bvh, {&geometry, 1}, 8, {}).size(0).units;
  EXPECT_NO_THROW(WideCollapse(bvh, {&geometry, 1}, 8, {}, units));
  const std::string words = error_of(ErrorCode::too_large, [&] {
    WideCollapse(bvh, {&geometry, 1}, 8, {}, units - 1);
  });
  EXPECT_EQ(words, "bvh8: 500 references are too many for it; bvh2 takes them");
}

TEST(WideCollapse, ItsMemoryCountsAndItsLimitIsKept) {
  const RandomTriangles triangles(kManyThings);
  const Geometry geometry = triangles.geometry();
  const Bvh bvh = lbvh_tree({&geometry, 1});
  const auto make = [&] { return make_wide_bvh<8>(bvh, {&geometry, 1}); };
  WorkMeter meter;
  WorkLimit limit;
  limit.meter = &meter;
  limit.bytes = peak_of_making(bvh, make) - 1;
  const LimitScope scope(&limit);
  error_of(ErrorCode::stopped, make);
  limit.bytes = static_cast<size_t>(-1);
  const std::atomic<bool> cancelled = true;
  limit.cancelled = &cancelled;
  error_of(ErrorCode::stopped, [&] { WideCollapse(bvh, {&geometry, 1}, 8, {}); });
}

TEST(WideTree, ReferencesOfOnePrimitiveInALeafStandOnce) {
  const SevenNodes hand;
  Bvh bvh = SevenNodes::bvh();
  constexpr uint32_t kRepeated = LeafSlot::kRepeated;
  bvh.slots = {{kRepeated, 2}, {0, 1}, {kRepeated, 2}, {kRepeated, 2}};
  const auto layout = make_wide_bvh<8>(bvh, hand.scene.geometries());
  ASSERT_EQ(layout.root.kind(), 2U);
  EXPECT_EQ(layout.slots(layout.root), (std::vector<LeafSlot>{{kRepeated, 2}, {0, 1}}));
  EXPECT_EQ(layout.triangles(layout.root).triangle(1).a, (Vec3f{2, 0, 0}));
}

TEST(WideTree, ATriangleWithoutAreaIsWrittenAsAPoint) {
  const std::vector<Vec3f> vertices = {{0.1F, 0.2F, 0.3F}, {0.2F, 0.4F, 0.6F}, {0.4F, 0.8F, 1.2F}, {1, 0, 0}};
  const std::vector<TriangleCorners> triangles = {{0, 1, 2}, {0, 1, 3}};
  const Geometry geometry{TriangleMesh{std::span<const Vec3f>(vertices), std::span<const TriangleCorners>(triangles)}};
  const LeafSlot slots[] = {{0, 0}, {0, 1}};
  std::vector<LeafUnit> units(TriangleLeaf::units(2));
  write_triangle_leaf(slots, {&geometry, 1}, units.data());
  const TriangleLeaf leaf{units[0].floats(), 2};
  EXPECT_EQ(leaf.triangle(0).a, vertices[0]);
  EXPECT_EQ(leaf.triangle(0).b, vertices[0]);
  EXPECT_EQ(leaf.triangle(0).c, vertices[0]);
  EXPECT_EQ(leaf.triangle(1).c, vertices[3]);
  EXPECT_EQ(leaf.slot(1), slots[1]);
}

TEST(WideTree, AnyNumberOfThreadsMakesTheSame) {
  const RandomTriangles triangles(kManyThings);
  const Geometry geometry = triangles.geometry();
  for (const bool split : {false, true}) {
    const Bvh bvh = lbvh_tree({&geometry, 1}, split);
    uint64_t hash4 = 0, hash8 = 0;
    for (const int threads : {1, 2, 7}) {
      with_threads(threads, [&] {
        const auto four = make_wide_bvh<4>(bvh, {&geometry, 1});
        const auto eight = make_wide_bvh<8>(bvh, {&geometry, 1});
        EXPECT_EQ(find_fault(four, {&geometry, 1}), std::nullopt);
        EXPECT_EQ(find_fault(eight, {&geometry, 1}), std::nullopt);
        if (threads == 1) hash4 = tree_hash(four), hash8 = tree_hash(eight);
        EXPECT_EQ(tree_hash(four), hash4);
        EXPECT_EQ(tree_hash(eight), hash8);
      });
    }
    EXPECT_NE(hash4, hash8);
  }
}

TEST(WideTree, NothingIsATreeToo) {
  const auto layout = make_wide_bvh<8>({}, {});
  EXPECT_TRUE(layout.is_empty());
  EXPECT_EQ(find_fault(layout, {}), std::nullopt);
  EXPECT_EQ(tree_hash(layout), 0U);
}

/// Damage to a tree of triangles, spheres and parallelograms; each must be found and must change the hash.
template <uint32_t kWidth>
void check_damage() {
  const MovingThings things = random_things(600, 4);
  const std::vector<Geometry> geometries = things.geometries();
  const auto whole = make_wide_bvh<kWidth>(lbvh_tree(geometries), geometries);
  ASSERT_EQ(find_fault(whole, geometries), std::nullopt);
  ASSERT_GT(whole.nodes.size(), 10U);
  const auto expect_found = [&](const std::string& what, const std::function<void(WideBvh<kWidth>&)>& damage,
                                const std::string& words) {
    WideBvh<kWidth> damaged = whole;
    damage(damaged);
    const std::optional<std::string> fault = find_fault(damaged, geometries);
    EXPECT_TRUE(fault && fault->find(words) != std::string::npos) << what << ": " << fault.value_or("nothing");
    EXPECT_NE(tree_hash(damaged), tree_hash(whole)) << what;
  };
  // A node with an inner child, one with a leaf of triangles, one with a leaf of others.
  const auto find_child = [&](auto&& is_wanted) {
    for (uint32_t n = 0; n < whole.nodes.size(); ++n) {
      for (uint32_t i = 0; i < kWidth && whole.nodes[n].has_child(i); ++i) {
        if (is_wanted(whole.nodes[n].child[i])) return std::pair(n, i);
      }
    }
    ADD_FAILURE();
    return std::pair(0U, 0U);
  };
  const auto inner = find_child([](WideChild c) { return !c.is_leaf(); });
  const auto leaf = find_child([](WideChild c) { return c.is_leaf() && c.kind() <= TriangleLeaf::kMost; });
  const auto other = find_child([](WideChild c) { return c.kind() == WideChild::kSlots; });
  const auto child = [](WideBvh<kWidth>& b, auto at) -> WideChild& { return b.nodes[at.first].child[at.second]; };
  for (uint32_t axis = 0; axis < 3; ++axis) {
    for (const uint32_t side : {0U, 1U}) {
      for (const auto& at : {inner, leaf, other}) {
        expect_found(
            "a box shrunk",
            [&](auto& b) {
              const float size = b.nodes[at.first].bounds(at.second).extent()[axis];
              b.nodes[at.first].sides[axis][side][at.second] += (side == 0 ? 1e-3F : -1e-3F) * (size + 0.01F);
            },
            "");
      }
    }
  }
  expect_found(
      "a box grown", [&](auto& b) { b.nodes[inner.first].sides[0][1][inner.second] += 1; }, "around its children");
  expect_found(
      "a child's number", [&](auto& b) { child(b, inner) = WideChild::of(0, b.nodes.size()); }, "is not there");
  expect_found(
      "a child twice", [&](auto& b) { child(b, inner) = WideChild::of(0, 0); }, "twice");
  expect_found(
      "a leaf's place", [&](auto& b) { child(b, leaf).word += 1U << WideChild::kKindBits; }, "where it should be");
  expect_found(
      "a leaf's kind", [&](auto& b) { child(b, leaf).word ^= 15; }, "where it should be");
  expect_found(
      "a leaf beyond all", [&](auto& b) { child(b, leaf) = WideChild::of(1, b.leaves.size()); }, "where it should be");
  expect_found(
      "a gap",
      [&](auto& b) {
        auto& node = b.nodes[inner.first];
        for (auto& sides : node.sides) sides[0][0] = Box3f::kInfinity, sides[1][0] = -Box3f::kInfinity;
      },
      "");
  expect_found(
      "a triangle", [&](auto& b) { b.leaves[child(b, leaf).number()].values[1] += 1; }, "the caller's triangles");
  expect_found(
      "a slot",
      [&](auto& b) {
        const WideChild at = child(b, other);
        const uint32_t wrong = 0x7FFFFFFF;
        std::memcpy(&b.leaves[at.number() + 1].values[1], &wrong, sizeof wrong);
      },
      "names no primitive");
  expect_found(
      "another slot",
      [&](auto& b) {
        const WideChild at = child(b, other);
        uint32_t primitive = 0;
        std::memcpy(&primitive, &b.leaves[at.number() + 1].values[1], sizeof primitive);
        primitive = primitive == 0 ? 1 : primitive - 1;
        std::memcpy(&b.leaves[at.number() + 1].values[1], &primitive, sizeof primitive);
      },
      "reaches out of its box");
  WideBvh<kWidth> longer = whole;
  longer.leaves = LineArray<LeafUnit>(whole.leaves.size() + 1);
  std::memcpy(static_cast<void*>(longer.leaves.data()), whole.leaves.data(), whole.leaves.bytes());
  EXPECT_EQ(find_fault(longer, geometries), "some units in no leaf");
}

TEST(WideTree, DamageIsFound) {
  check_damage<4>();
  check_damage<8>();
}

/// A chain as deep as trees may be, each node with as many leaves as it has room for; a ray that enters every box goes
/// down to the end first, with all the leaves waiting.
template <uint32_t kWidth>
void check_deepest() {
  HandScene scene;
  for (int i = 0; i < 2; ++i) scene.add(static_cast<float>(i + 1));
  const Box3f box{{0, 0, 0}, {3, 1, 1}};
  WideTracer<WideBvh<kWidth>> tracer;
  tracer.geometries = scene.geometries();
  WideBvh<kWidth>& layout = tracer.layout;
  constexpr size_t kLeaves = (kWidth - 1) * kMaxDepth + 1;
  layout.bounds = box;
  layout.root = WideChild::of(WideChild::kInner, 0);
  layout.nodes = LineArray<WideNode<kWidth>>(kMaxDepth);
  layout.leaves = LineArray<LeafUnit>(kLeaves * TriangleLeaf::units(1) + TriangleLeaf::kPadding);
  size_t leaf = kLeaves;  // the deepest leaves come first
  for (uint32_t n = 0; n < kMaxDepth; ++n) {
    for (uint32_t i = 0; i < kWidth; ++i) {
      layout.nodes[n].set_bounds(i, box);
      if (i == 0 && n + 1 < kMaxDepth) {
        layout.nodes[n].child[i] = WideChild::of(WideChild::kInner, n + 1);
        continue;
      }
      --leaf;
      layout.nodes[n].child[i] = WideChild::of(1, leaf * TriangleLeaf::units(1));
      const LeafSlot slot{0, leaf == kLeaves / 2 ? 0U : 1U};
      write_triangle_leaf({&slot, 1}, tracer.geometries, &layout.leaves[leaf * TriangleLeaf::units(1)]);
    }
  }
  ASSERT_EQ(leaf, 0U);
  const TraceTable& table = *wide_kernels<WideBvh<kWidth>>().table;
  TraceCounts counts;
  const Ray ray{.origin = {-1, 0.25F, 0.25F}, .direction = {1, 0, 0}};
  EXPECT_EQ(table.closest_counted(&tracer, ray, counts).primitive, 0U);
  EXPECT_EQ(counts.nodes, kMaxDepth + kLeaves);
  EXPECT_EQ(table.closest(&tracer, ray).primitive, 0U);
  EXPECT_TRUE(table.any(&tracer, ray));
  EXPECT_FALSE(table.any(&tracer, {.origin = {-1, 0.75F, 0.75F}, .direction = {1, 0, 0}}));
}

TEST(WideTree, TheDeepestFitsTheStack) {
  check_deepest<4>();
  check_deepest<8>();
}

TEST(WideTree, AChainAsDeepAsTreesMayBe) {
  HandScene scene;
  Bvh bvh;
  for (uint32_t i = 0; i <= kMaxDepth; ++i) {
    scene.add(static_cast<float>(1U << (i % 31)) + static_cast<float>(i));
    bvh.slots.push_back({0, i});
  }
  bvh.nodes.resize(2 * kMaxDepth + 1);
  Box3f box;
  for (uint32_t i = kMaxDepth + 1; i-- > 0;) {
    const Box3f own = primitive_bounds(scene.geometries()[0], i);
    box.extend(own);
    const bool is_last = i == kMaxDepth;
    const uint32_t leaf = is_last ? 2 * i : 2 * i + 1;
    bvh.nodes[leaf] = {own.lower, i, own.upper, 1};
    if (!is_last) bvh.nodes[2 * i] = {box.lower, 2 * i + 1, box.upper, 0};
  }
  ASSERT_EQ(find_fault(bvh, scene.geometries(), 1), std::nullopt);
  EXPECT_EQ(measure(bvh).depth, kMaxDepth);
  for (const double leaf_cost : {0.7, 0.0, 100.0}) {
    WideCosts costs;
    costs.leaf = leaf_cost;
    const auto layout = make_wide_bvh<4>(bvh, scene.geometries(), costs);
    EXPECT_EQ(find_fault(layout, scene.geometries()), std::nullopt);
  }
}

}  // namespace
}  // namespace kerf::test
