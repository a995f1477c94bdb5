// The quantised layout: sides that are never inside the boxes they stand for, leaves that share corners, damage that is
// found, and bounds that hold.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "kerf/base/instruction_set.h"
#include "kerf/base/parallel.h"
#include "kerf/layout/quantised_bvh.h"
#include "kerf/layout/wide_collapse.h"
#include "kerf/scene/scene.h"
#include "kerf/trace/trace_wide.h"
#include "tests/support/environment.h"
#include "tests/support/error_of.h"
#include "tests/support/hand_tree.h"
#include "tests/support/moving_things.h"
#include "tests/support/random_scene.h"
#include "tests/support/sizes.h"
#include "tests/support/wide_trees.h"

namespace kerf::test {
namespace {

/// A bumpy square of so many squares of two triangles each, with two colours in turn, each a geometry over the same
/// vertices.
struct BumpyMesh {
  std::vector<Vec3f> vertices;
  std::vector<TriangleCorners> triangles[2];

  explicit BumpyMesh(uint32_t side, bool is_mixed = true) {
    Random random(side);
    for (uint32_t y = 0; y <= side; ++y) {
      for (uint32_t x = 0; x <= side; ++x) {
        vertices.push_back({static_cast<float>(x), static_cast<float>(y), random.share()});
      }
    }
    for (uint32_t y = 0; y < side; ++y) {
      for (uint32_t x = 0; x < side; ++x) {
        const uint32_t a = y * (side + 1) + x, c = a + side + 1;
        auto& to = triangles[is_mixed && (x / 3 + y) % 2 == 1 ? 1 : 0];
        to.push_back({a, a + 1, c});
        to.push_back({a + 1, c + 1, c});
      }
    }
  }
  std::vector<Geometry> geometries() const {
    const Strided<Vec3f> points(vertices.data(), vertices.size());
    return {{TriangleMesh{points, {triangles[0].data(), triangles[0].size()}}},
            {TriangleMesh{points, {triangles[1].data(), triangles[1].size()}}}};
  }
};

/// Boxes like a node's children: of any size, one flat, two alike, all within `size` of `at`.
std::vector<Box3f> some_boxes(Random& random, Vec3f at, float size) {
  std::vector<Box3f> boxes(1 + random.below(8));
  const float shares[] = {1, 1e-2F, 1e-5F, 0};
  for (Box3f& box : boxes) {
    const Vec3f corner = at + size * random.vector();
    box.extend(corner);
    box.extend(corner + size * shares[random.below(4)] * random.vector());
  }
  if (random.below(4) == 0) boxes.back() = boxes.front();
  return boxes;
}

TEST(QuantisedNode, HoldsItsBoxesWhateverTheSizeOfNumbers) {
  Random random(1);
  for (const float size : {1e-45F, 1e-40F, 1e-38F, 1e-20F, 1.0F, 1e10F, 1e30F, 1e36F}) {
    for (const float way : {0.0F, 1.0F, 1e4F, 1e7F}) {
      if (size * way > 1e36F) continue;
      for (int i = 0; i < 100; ++i) {
        const std::vector<Box3f> boxes = some_boxes(random, size * way * random.vector(), size);
        Box3f all;
        for (const Box3f& box : boxes) all.extend(box);
        QuantisedNode node;
        node.set_bounds(boxes);
        for (uint32_t k = 0; k < QuantisedNode::kWidth; ++k) ASSERT_EQ(node.has_child(k), k < boxes.size());
        for (uint32_t k = 0; k < boxes.size(); ++k) {
          const Box3f bounds = node.bounds(k);
          ASSERT_TRUE(bounds.contains(boxes[k])) << size << ", " << way;
          for (uint32_t axis = 0; axis < 3; ++axis) {
            // Not more than two steps too far, and two of the last places.
            const float largest = std::max(std::abs(all.lower[axis]), std::abs(all.upper[axis]));
            const float slack = 2e-3F * all.extent()[axis] + 0x1p-20F * largest + 0x1p-145F;
            ASSERT_LE(boxes[k].lower[axis] - bounds.lower[axis], slack) << size << ", " << way;
            ASSERT_LE(bounds.upper[axis] - boxes[k].upper[axis], slack) << size << ", " << way;
            if (all.lower[axis] == all.upper[axis]) {
              ASSERT_EQ(bounds.lower[axis], bounds.upper[axis]);
            }
          }
        }
      }
    }
  }
}

TEST(QuantisedLeaf, TrianglesShareCorners) {
  const BumpyMesh mesh(2, false);
  const std::vector<Geometry> geometries = mesh.geometries();
  std::vector<LeafSlot> slots;
  for (uint32_t i = 0; i < 8; ++i) slots.push_back({i % 3 == 0 ? LeafSlot::kRepeated : 0, i});
  const QuantisedLeafSize size = quantised_leaf_size(slots, geometries, CornerKind::places);
  EXPECT_EQ(size.corners, 9U);
  EXPECT_EQ(size.units, 10U) << "4 + 9 * 12 + 8 * 2 + 8 * 4 bytes";
  std::vector<LeafUnit> units(size.units);
  EXPECT_EQ(write_quantised_leaf(slots, geometries, CornerKind::places, units.data()), 9U);
  const QuantisedLeaf leaf{units[0].floats(), 9};
  EXPECT_EQ(leaf.count(), 8U);
  EXPECT_FALSE(leaf.is_mixed());
  EXPECT_EQ(leaf.units(), size.units);
  for (uint32_t i = 0; i < 8; ++i) {
    const Triangle expected = std::get<TriangleMesh>(geometries[0].shapes).triangle(i);
    EXPECT_EQ(leaf.triangle(i).a, expected.a);
    EXPECT_EQ(leaf.triangle(i).b, expected.b);
    EXPECT_EQ(leaf.triangle(i).c, expected.c);
    EXPECT_EQ(leaf.slot(i), slots[i]);
  }
}

TEST(QuantisedLeaf, MayBeOfSeveralGeometriesAndOfPoints) {
  const std::vector<Vec3f> vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {2, 0, 0}};
  const std::vector<TriangleCorners> one = {{0, 1, 2}, {0, 1, 4}}, two = {{3, 2, 1}};
  const std::span<const Vec3f> points(vertices);
  const std::vector<Geometry> geometries = {{TriangleMesh{points, std::span<const TriangleCorners>(one)}},
                                            {TriangleMesh{points, std::span<const TriangleCorners>(two)}}};
  const std::vector<LeafSlot> slots = {{0, 0}, {0, 1}, {1 | LeafSlot::kRepeated, 0}};
  std::vector<LeafUnit> units(8);
  // By places vertex 3 is vertex 0, and of the triangle without area one corner counts; vertices are what they are.
  EXPECT_EQ(write_quantised_leaf(slots, geometries, CornerKind::places, units.data()), 3U);
  const QuantisedLeaf leaf{units[0].floats(), 3};
  EXPECT_TRUE(leaf.is_mixed());
  for (uint32_t i = 0; i < 3; ++i) EXPECT_EQ(leaf.slot(i), slots[i]);
  EXPECT_EQ(leaf.triangle(1).a, vertices[0]);
  EXPECT_EQ(leaf.triangle(1).b, vertices[0]);
  EXPECT_EQ(leaf.triangle(1).c, vertices[0]);
  EXPECT_EQ(leaf.triangle(2).c, vertices[1]);
  EXPECT_EQ(quantised_leaf_size(slots, geometries, CornerKind::vertices).corners, 7U);
}

TEST(QuantisedBvh, MeshesAreHitAsByBruteForceOnEveryInstructionSet) {
  const BumpyMesh mesh(40);
  std::vector<Geometry> geometries = mesh.geometries();
  for (const uint32_t mask : {0xFFFFFFFFU, 2U}) {
    geometries[1].mask = mask;
    Scene brute;
    for (const Geometry& geometry : geometries) brute.add(geometry);
    brute.build({.structure = "brute_force"});
    Random random(4);
    std::vector<Ray> rays;
    for (int i = 0; i < 2000; ++i) {
      Ray ray{.origin = 20.0F * random.vector() + Vec3f{20, 20, 5}, .direction = random.vector()};
      if (i % 3 == 0) ray.direction = mesh.vertices[random.below(1600)] - ray.origin;
      if (i % 5 == 0) ray.mask = 1;
      rays.push_back(ray);
    }
    for (const std::string_view set : instruction_sets()) {
      const ScopedVariable isa("KERF_ISA", std::string(set));
      for (const std::string structure :
           {"binned_sah(leaf=8)+quantised_bvh8(leaf_cost=100)", "lbvh(leaf=4)+quantised_bvh8(triangle_cost=1)"}) {
        Scene scene;
        for (const Geometry& geometry : geometries) scene.add(geometry);
        scene.build({.structure = structure});
        ASSERT_EQ(scene.structure().find_fault(), std::nullopt);
        size_t hits = 0;
        for (const Ray& ray : rays) {
          const Hit hit = brute.closest_hit(ray);
          ASSERT_EQ(scene.closest_hit(ray), hit) << set << ", " << structure;
          ASSERT_EQ(scene.any_hit(ray), static_cast<bool>(hit)) << set << ", " << structure;
          hits += hit ? 1 : 0;
        }
        EXPECT_GT(hits, rays.size() / 4);
      }
    }
  }
}

TEST(QuantisedBvh, TakesHalfTheMemoryOfTheFullLayout) {
  const BumpyMesh mesh(100, false);
  const std::vector<Geometry> geometries = mesh.geometries();
  const Bvh bvh = lbvh_tree(geometries);
  const auto layout = make_quantised_bvh(bvh, geometries);
  EXPECT_EQ(find_fault(layout, geometries), std::nullopt);
  EXPECT_LT(static_cast<double>(layout.bytes()), 0.58 * static_cast<double>(make_wide_bvh<8>(bvh, geometries).bytes()));
}

TEST(QuantisedBvh, AnyNumberOfThreadsMakesTheSame) {
  const RandomTriangles triangles(kManyThings);
  const Geometry geometry = triangles.geometry();
  const Bvh bvh = lbvh_tree({&geometry, 1});
  uint64_t hash = 0;
  for (const int threads : {1, 2, 7}) {
    with_threads(threads, [&] {
      const auto layout = make_quantised_bvh(bvh, {&geometry, 1});
      EXPECT_EQ(find_fault(layout, {&geometry, 1}), std::nullopt);
      if (threads == 1) hash = tree_hash(layout);
      EXPECT_EQ(tree_hash(layout), hash);
    });
  }
}

TEST(QuantisedBvh, ItsMemoryCountsAndItsNameIsInErrors) {
  const RandomTriangles triangles(kManyThings);
  const Geometry geometry = triangles.geometry();
  const Bvh bvh = lbvh_tree({&geometry, 1});
  peak_of_making(bvh, [&] { return make_quantised_bvh(bvh, {&geometry, 1}); });
  const WideCollapse::LeafUnits large = [](std::span<const LeafSlot>, std::span<const Geometry>) { return size_t{99}; };
  const std::string words = error_of(ErrorCode::too_large, [&] {
    WideCollapse(bvh, {&geometry, 1}, 8, {}, 98, large, "quantised_bvh");
  });
  EXPECT_EQ(words.substr(0, words.find(':')), "quantised_bvh8");
}

TEST(QuantisedBvh, NothingIsATreeToo) {
  const auto layout = make_quantised_bvh({}, {});
  EXPECT_TRUE(layout.is_empty());
  EXPECT_EQ(find_fault(layout, {}), std::nullopt);
  EXPECT_EQ(tree_hash(layout), 0U);
}

using Place = std::pair<uint32_t, uint32_t>;  // a node and which of its children

/// A tree of triangles, spheres and parallelograms to be damaged: every damage must be found and change the hash.
class DamagedTree : public testing::Test {
 protected:
  DamagedTree() : geometries_(things_.geometries()), whole_(make_quantised_bvh(lbvh_tree(geometries_), geometries_)) {
    EXPECT_EQ(find_fault(whole_, geometries_), std::nullopt);
    EXPECT_GT(whole_.nodes.size(), 10U);
  }

  Place find_child(const std::function<bool(QuantisedChild)>& is_wanted) const {
    for (uint32_t n = 0; n < whole_.nodes.size(); ++n) {
      for (uint32_t i = 0; i < whole_.nodes[n].children; ++i) {
        if (is_wanted(whole_.nodes[n].child[i])) return {n, i};
      }
    }
    ADD_FAILURE();
    return {};
  }
  Place inner() const {
    return find_child([](QuantisedChild c) { return !c.is_leaf(); });
  }
  Place leaf() const {
    return find_child([](QuantisedChild c) { return c.is_leaf() && c.kind() != QuantisedChild::kSlots; });
  }
  Place other() const {
    return find_child([](QuantisedChild c) { return c.kind() == QuantisedChild::kSlots; });
  }
  static QuantisedChild& child(QuantisedBvh& layout, Place at) { return layout.nodes[at.first].child[at.second]; }

  void expect_found(const std::string& what, const std::function<void(QuantisedBvh&)>& damage,
                    const std::string& words) const {
    QuantisedBvh damaged = whole_;
    damage(damaged);
    const std::optional<std::string> fault = find_fault(damaged, geometries_);
    EXPECT_TRUE(fault && fault->find(words) != std::string::npos) << what << ": " << fault.value_or("nothing");
    EXPECT_NE(tree_hash(damaged), tree_hash(whole_)) << what;
  }

  MovingThings things_ = random_things(600, 4);
  std::vector<Geometry> geometries_;
  QuantisedBvh whole_;
};

TEST_F(DamagedTree, BoxesAreFound) {
  for (uint32_t axis = 0; axis < 3; ++axis) {
    const uint32_t step = 1U << QuantisedNode::kPlaces[axis];
    for (const Place& at : {inner(), leaf(), other()}) {
      expect_found(
          "a box shrunk", [&](auto& b) { b.nodes[at.first].sides[0][at.second] += 2 * step; }, "");
      expect_found(
          "a box shrunk", [&](auto& b) { b.nodes[at.first].sides[1][at.second] -= 2 * step; }, "");
    }
    expect_found(
        "a box grown", [&](auto& b) { b.nodes[inner().first].sides[1][inner().second] += 2 * step; }, "");
    for (const float factor : {0.9F, 1.1F}) {
      expect_found(
          "a size", [&](auto& b) { b.nodes[0].size[axis] *= factor; }, "");
    }
    expect_found(
        "a base", [&](auto& b) { b.nodes[0].base[axis] += 0.1F; }, "");
  }
}

TEST_F(DamagedTree, ChildrenAreFound) {
  expect_found(
      "none", [](auto& b) { b.nodes[1].children = 0; }, "");
  expect_found(
      "one less", [](auto& b) { --b.nodes[1].children; }, "");
  expect_found(
      "too many", [](auto& b) { b.nodes[1].children = 9; }, "");
  expect_found(
      "a number", [&](auto& b) { child(b, inner()) = QuantisedChild::of(0, b.nodes.size()); }, "is not there");
  expect_found(
      "one twice", [&](auto& b) { child(b, inner()) = QuantisedChild::of(0, 0); }, "twice");
  const auto move_leaf = [&](auto& b) { child(b, leaf()).word += 1U << QuantisedChild::kKindBits; };
  expect_found("a leaf's place", move_leaf, "where it should be");
  expect_found(
      "a leaf's kind", [&](auto& b) { child(b, leaf()).word ^= 1; }, "");
  const auto no_kind = [&](auto& b) { child(b, leaf()) = QuantisedChild::of(28, child(b, leaf()).number()); };
  expect_found("a leaf's kind", no_kind, "where it should be");
  const auto move_beyond = [&](auto& b) { child(b, leaf()) = QuantisedChild::of(3, b.leaves.size()); };
  expect_found("a leaf beyond all", move_beyond, "where it should be");
}

TEST_F(DamagedTree, LeavesAreFound) {
  const auto bytes_of = [&](QuantisedBvh& b, Place at) {
    return reinterpret_cast<unsigned char*>(&b.leaves[child(b, at).number()]);
  };
  expect_found(
      "a corner", [&](auto& b) { b.leaves[child(b, leaf()).number()].values[1] += 1; }, "the caller's");
  expect_found(
      "a count", [&](auto& b) { bytes_of(b, leaf())[0] ^= 1; }, "");
  expect_found(
      "a geometry", [&](auto& b) { bytes_of(b, leaf())[1] ^= 1; }, "names no primitive");
  expect_found(
      "a geometry that is no mesh", [&](auto& b) { bytes_of(b, leaf())[0] ^= 16; }, "");
  const QuantisedChild at = child(whole_, leaf());
  const size_t words = size_t{4} + size_t{12} * at.kind();
  expect_found(
      "a corner's number", [&](auto& b) { bytes_of(b, leaf())[words] ^= 1; }, "the caller's");
  expect_found(
      "a primitive", [&](auto& b) { bytes_of(b, leaf())[words + 4 * ((whole_.triangles(at).count() + 1) / 2)] ^= 1; },
      "");
  expect_found(
      "a slot", [&](auto& b) { bytes_of(b, other())[23] = 0x7F; }, "names no primitive");
  QuantisedBvh longer = whole_;
  longer.leaves = LineArray<LeafUnit>(whole_.leaves.size() + 1);
  std::memcpy(static_cast<void*>(longer.leaves.data()), whole_.leaves.data(), whole_.leaves.bytes());
  EXPECT_EQ(find_fault(longer, geometries_), "some units in no leaf");
}

/// A chain as deep as trees may be, each node with as many leaves as it has room for; a ray that enters every box goes
/// down to the end first, with all the leaves waiting.
TEST(QuantisedBvh, TheDeepestFitsTheStack) {
  HandScene scene;
  for (int i = 0; i < 2; ++i) scene.add(static_cast<float>(i + 1));
  const Box3f box{{0, 0, 0}, {3, 1, 1}};
  const std::vector<Box3f> boxes(QuantisedNode::kWidth, box);
  WideTracer<QuantisedBvh> tracer;
  tracer.geometries = scene.geometries();
  QuantisedBvh& layout = tracer.layout;
  constexpr size_t kLeaves = (QuantisedNode::kWidth - 1) * kMaxDepth + 1, kUnits = QuantisedLeaf::units(1, 3, false);
  layout.bounds = box;
  layout.root = QuantisedChild::of(QuantisedChild::kInner, 0);
  layout.nodes = LineArray<QuantisedNode>(kMaxDepth);
  layout.leaves = LineArray<LeafUnit>(kLeaves * kUnits + TriangleLeaf::kPadding);
  size_t leaf = kLeaves;  // the deepest leaves come first
  for (uint32_t n = 0; n < kMaxDepth; ++n) {
    layout.nodes[n].set_bounds(boxes);
    for (uint32_t i = 0; i < QuantisedNode::kWidth; ++i) {
      if (i == 0 && n + 1 < kMaxDepth) {
        layout.nodes[n].child[i] = QuantisedChild::of(QuantisedChild::kInner, n + 1);
        continue;
      }
      --leaf;
      const LeafSlot slot{0, leaf == kLeaves / 2 ? 0U : 1U};
      layout.nodes[n].child[i] = layout.write_leaf({&slot, 1}, true, tracer.geometries, leaf * kUnits);
    }
  }
  ASSERT_EQ(leaf, 0U);
  tracer.update();
  const TraceTable& table = *wide_kernels<QuantisedBvh>().table;
  TraceCounts counts;
  const Ray ray{.origin = {-1, 0.25F, 0.25F}, .direction = {1, 0, 0}};
  EXPECT_EQ(table.closest_counted(&tracer, ray, counts).primitive, 0U);
  EXPECT_EQ(counts.nodes, kMaxDepth + kLeaves);
  EXPECT_EQ(table.closest(&tracer, ray).primitive, 0U);
  EXPECT_TRUE(table.any(&tracer, ray));
  EXPECT_FALSE(table.any(&tracer, {.origin = {-1, 0.75F, 0.75F}, .direction = {1, 0, 0}}));
}

}  // namespace
}  // namespace kerf::test
