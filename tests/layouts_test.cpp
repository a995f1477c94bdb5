// Child orders, box tests, skip pointers and packets: what is visited on a tree of seven nodes that was worked by hand,
// damage that is found, and bounds that hold.

#include <gtest/gtest.h>

#include <cmath>

#include "kerf/base/error.h"
#include "kerf/layout/skip_pointer.h"
#include "kerf/scene/scene.h"
#include "kerf/trace/trace_bvh2.h"
#include "kerf/trace/trace_packets.h"
#include "kerf/trace/trace_skip_pointer.h"
#include "tests/support/hand_tree.h"
#include "tests/support/random.h"

namespace kerf::test {
namespace {

TraceCounts counts_of(const TraceTable& table, const void* tracer, const Ray& ray, uint32_t expected) {
  TraceCounts counts;
  const Hit hit = table.closest_counted(tracer, ray, counts);
  EXPECT_EQ(hit ? hit.primitive : kNone, expected);
  EXPECT_EQ(table.closest(tracer, ray), hit);
  EXPECT_EQ(table.any(tracer, ray), static_cast<bool>(hit));
  return counts;
}

template <class Tracer>
TraceCounts bvh2_counts(const HandScene& scene, Bvh bvh, const Ray& ray, uint32_t expected) {
  EXPECT_EQ(find_fault(bvh, scene.geometries(), 1), std::nullopt);
  Tracer tracer{make_bvh2(std::move(bvh)), scene.geometries()};
  if (std::is_same_v<Tracer, Bvh2TracerOf<ChildOrder::axis, BoxRay>>) mark_axes(tracer.layout);
  return counts_of(Tracer::table(), &tracer, ray, expected);
}

using Fixed = Bvh2TracerOf<ChildOrder::fixed, BoxRay>;
using Axis = Bvh2TracerOf<ChildOrder::axis, BoxRay>;
using Heap = Bvh2TracerOf<ChildOrder::heap, BoxRay>;

TEST(ChildOrders, FixedVisitsTheFirstChildFirst) {
  const SevenNodes hand;
  expect_counts(bvh2_counts<Fixed>(hand.scene, hand.bvh(), hand.from_left(), 0), 3, 1, 5);
  // All seven: the hits at x = 1, 2, 3, 4 come nearer and nearer.
  expect_counts(bvh2_counts<Fixed>(hand.scene, hand.bvh(), hand.from_right(), 3), 7, 4, 7);
  expect_counts(bvh2_counts<Fixed>(hand.scene, hand.exchanged(), hand.from_left(), 0), 5, 2, 7);
  expect_counts(bvh2_counts<Fixed>(hand.scene, hand.bvh(), hand.through_boxes(), kNone), 7, 4, 7);
  expect_counts(bvh2_counts<Fixed>(hand.scene, hand.bvh(), hand.beside(), kNone), 0, 0, 1);
}

TEST(ChildOrders, AxisFollowsTheSignOfTheDirection) {
  const SevenNodes hand;
  for (const Bvh& bvh : {hand.bvh(), hand.exchanged()}) {
    expect_counts(bvh2_counts<Axis>(hand.scene, bvh, hand.from_left(), 0), 3, 1, 5);
    expect_counts(bvh2_counts<Axis>(hand.scene, bvh, hand.from_right(), 3), 3, 1, 5);
    expect_counts(bvh2_counts<Axis>(hand.scene, bvh, hand.through_boxes(), kNone), 7, 4, 7);
    expect_counts(bvh2_counts<Axis>(hand.scene, bvh, hand.beside(), kNone), 0, 0, 1);
  }
}

TEST(ChildOrders, HeapVisitsTheNearestOfAllThatWait) {
  const SevenNodes hand;
  for (const Bvh& bvh : {hand.bvh(), hand.exchanged()}) {
    expect_counts(bvh2_counts<Heap>(hand.scene, bvh, hand.from_left(), 0), 3, 1, 5);
    expect_counts(bvh2_counts<Heap>(hand.scene, bvh, hand.from_right(), 3), 3, 1, 5);
    expect_counts(bvh2_counts<Heap>(hand.scene, bvh, hand.through_boxes(), kNone), 7, 4, 7);
    expect_counts(bvh2_counts<Heap>(hand.scene, bvh, hand.beside(), kNone), 0, 0, 1);
  }
  // 1 [1,9] over 3 [1], which is missed, and 4 [9]; 2 [3,4] over 5 [3] and 6 [4]. A stack goes to 9 before 3.
  HandScene scene;
  scene.add(1, true);
  for (const float x : {9.0F, 3.0F, 4.0F}) scene.add(x);
  Bvh bvh;
  bvh.nodes = {inner_node(1, 9, 1), inner_node(1, 9, 3), inner_node(3, 4, 5), leaf_node(1, 0),
               leaf_node(9, 1),     leaf_node(3, 2),     leaf_node(4, 3)};
  for (uint32_t i = 0; i < 4; ++i) bvh.slots.push_back({0, i});
  expect_counts(bvh2_counts<Bvh2Tracer>(scene, bvh, hand.from_left(), 2), 6, 3, 7);
  expect_counts(bvh2_counts<Heap>(scene, bvh, hand.from_left(), 2), 5, 2, 7);
}

/// A soup in which a ray from the middle begins in nearly every box.
struct Soup {
  std::vector<Vec3f> vertices;
  std::vector<TriangleCorners> triangles;

  Soup() {
    Random random(3);
    for (uint32_t i = 0; i < 4000; ++i) {
      const Vec3f a = 10.0F * random.vector(), b = 10.0F * random.vector();
      const auto first = static_cast<uint32_t>(vertices.size());
      vertices.insert(vertices.end(), {a, b, random.vector() - 0.5F * (a + b)});
      triangles.push_back({first, first + 1, first + 2});
    }
  }
};

TEST(ChildOrders, AHeapWithoutRoomLosesNothing) {
  const Soup soup;
  Scene brute, heap, stack;
  for (Scene* scene : {&brute, &heap, &stack}) scene->add({std::span(soup.vertices), std::span(soup.triangles)});
  brute.build({.structure = "brute_force"});
  heap.build({.structure = "binned_sah(leaf=1)+bvh2(order=heap)"});
  stack.build({.structure = "binned_sah(leaf=1)"});
  Random random(5);
  TraceCounts heap_counts, stack_counts;
  for (int i = 0; i < 200; ++i) {
    const Ray ray{.origin = 0.1F * random.vector(), .direction = random.vector()};
    const Hit expected = brute.closest_hit(ray);
    ASSERT_EQ(heap.closest_hit(ray, heap_counts), expected) << i;
    ASSERT_EQ(heap.any_hit(ray), static_cast<bool>(expected)) << i;
    stack.closest_hit(ray, stack_counts);
  }
  // So many nodes have the same entry, that of the ray itself, that more than the heap has room for must wait.
  EXPECT_GT(heap_counts.nodes, 200U * 512);
  EXPECT_LT(heap_counts.nodes, 2 * stack_counts.nodes);
}

TEST(ChildOrders, AnotherBoxTestGoesWithEntryOnly) {
  Scene scene;
  EXPECT_THROW(scene.build({.structure = "binned_sah+bvh2(order=heap,box=naive)"}), Error);
  EXPECT_NO_THROW(scene.build({.structure = "binned_sah+bvh2(order=entry,box=naive)"}));
  EXPECT_NO_THROW(scene.build({.structure = "binned_sah+bvh2(order=heap,box=ours)"}));
}

TEST(ChildOrders, WrongAxesAreFound) {
  Bvh2 layout = make_bvh2(SevenNodes::exchanged());
  const Bvh2Child plain = layout.root;
  mark_axes(layout);
  EXPECT_EQ(layout.root.count, Bvh2Child::kAxisMark | Bvh2Child::kSecondIsLower | 0U);
  EXPECT_EQ(layout.nodes[0].child[0].count, Bvh2Child::kAxisMark | 0U);
  EXPECT_EQ(find_axis_fault(layout), std::nullopt);
  EXPECT_EQ(tree_hash(make_bvh(layout)), tree_hash(SevenNodes::exchanged()));
  for (const uint32_t wrong : {plain.count, Bvh2Child::kAxisMark, layout.root.count | 1U}) {
    Bvh2 damaged = layout;
    damaged.root.count = wrong;
    EXPECT_NE(find_axis_fault(damaged), std::nullopt) << wrong;
  }
  layout.nodes[0].child[1].count |= Bvh2Child::kSecondIsLower;
  EXPECT_NE(find_axis_fault(layout), std::nullopt);
}

template <class BoxTest>
class BoxTests : public testing::Test {};
using AllBoxTests = testing::Types<BoxRay, NaiveBoxRay, WilliamsBoxRay, PlueckerBoxRay>;
TYPED_TEST_SUITE(BoxTests, AllBoxTests);

TYPED_TEST(BoxTests, VisitTheSameNodesOfTheHandTree) {
  using Tracer = Bvh2TracerOf<ChildOrder::entry, TypeParam>;
  const SevenNodes hand;
  expect_counts(bvh2_counts<Tracer>(hand.scene, hand.bvh(), hand.from_left(), 0), 3, 1, 5);
  expect_counts(bvh2_counts<Tracer>(hand.scene, hand.bvh(), hand.from_right(), 3), 3, 1, 5);
  expect_counts(bvh2_counts<Tracer>(hand.scene, hand.bvh(), hand.through_boxes(), kNone), 7, 4, 7);
  expect_counts(bvh2_counts<Tracer>(hand.scene, hand.bvh(), hand.beside(), kNone), 0, 0, 1);
  Ray within = hand.from_left();
  within.t_min = 2.5F;
  within.t_max = 2.75F;
  expect_counts(bvh2_counts<Tracer>(hand.scene, hand.bvh(), within, kNone), 1, 0, 3);
  within.t_max = 3;
  expect_counts(bvh2_counts<Tracer>(hand.scene, hand.bvh(), within, 2), 3, 1, 5);
}

/// Whether the segment [t_min, limit] of a ray meets a box, in long double.
bool truly_enters(const Ray& ray, const Box3f& box, float limit) {
  long double near = ray.t_min, far = limit;
  for (uint32_t axis = 0; axis < 3; ++axis) {
    const long double o = ray.origin[axis], d = ray.direction[axis];
    if (d == 0) {
      if (o < box.lower[axis] || o > box.upper[axis]) return false;
      continue;
    }
    const long double a = (box.lower[axis] - o) / d, b = (box.upper[axis] - o) / d;
    near = std::max(near, std::min(a, b));
    far = std::min(far, std::max(a, b));
  }
  return near <= far;
}

TYPED_TEST(BoxTests, MissNoBoxAndFewAreEnteredInVain) {
  Random random(11);
  const Box3f scene{{-10, -10, -10}, {10, 10, 10}};
  size_t entered = 0, truly = 0;
  for (int i = 0; i < 200000; ++i) {
    // Coarse numbers, so that rays run through edges and corners and along sides; directions with zeros among them.
    const auto coarse = [&](float scale) {
      const Vec3f v = random.vector();
      return Vec3f{std::round(4 * v.x), std::round(4 * v.y), std::round(4 * v.z)} * (scale / 4);
    };
    const Ray ray{.origin = coarse(10), .t_min = i % 3 == 0 ? 0.5F : 0, .direction = coarse(1)};
    const PreparedRay prepared(ray);
    if (!prepared.valid) continue;
    Bvh2Child child;
    const Vec3f a = coarse(10), b = coarse(10);
    child.lower = min(a, b);
    child.upper = max(a, b);
    const float limit = i % 4 == 0 ? 8 : std::numeric_limits<float>::infinity();
    float entry = -1;
    const bool enters = TypeParam(prepared, scene).enters(child.sides(), ray.t_min, limit, entry);
    const bool truth = truly_enters(ray, child.bounds(), limit);
    ASSERT_TRUE(enters || !truth) << i;
    if (enters) {
      ASSERT_GE(entry, ray.t_min) << i;
      ASSERT_LE(entry, limit) << i;
    }
    entered += enters ? 1 : 0;
    truly += truth ? 1 : 0;
  }
  EXPECT_GT(truly, 10000U);
  EXPECT_LE(entered, truly + truly / 1000);
}

TraceCounts skip_counts(const HandScene& scene, Bvh bvh, const Ray& ray, uint32_t expected) {
  const SkipPointerTracer tracer{make_skip_pointer_bvh(std::move(bvh)), scene.geometries()};
  EXPECT_EQ(find_fault(tracer.layout, scene.geometries(), 1), std::nullopt);
  return counts_of(skip_pointer_table(), &tracer, ray, expected);
}

TEST(SkipPointers, VisitTheHandTreeInFixedOrder) {
  const SevenNodes hand;
  expect_counts(skip_counts(hand.scene, hand.bvh(), hand.from_left(), 0), 3, 1, 5);  // the boxes of 0, 1, 3, 4, 2
  expect_counts(skip_counts(hand.scene, hand.bvh(), hand.from_right(), 3), 7, 4, 7);
  expect_counts(skip_counts(hand.scene, hand.exchanged(), hand.from_left(), 0), 5, 2, 7);  // 4 [4] is behind 3 [3]
  expect_counts(skip_counts(hand.scene, hand.bvh(), hand.through_boxes(), kNone), 7, 4, 7);
  expect_counts(skip_counts(hand.scene, hand.bvh(), hand.beside(), kNone), 0, 0, 1);
}

TEST(SkipPointers, AreTheTreeAndTellOfDamage) {
  const SevenNodes hand;
  const SkipPointerBvh layout = make_skip_pointer_bvh(hand.bvh());
  const std::optional<Bvh> back = make_bvh(layout);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->nodes.size(), 7U);
  EXPECT_EQ(sah_cost(*back), sah_cost(hand.bvh()));
  const auto fault_after = [&](auto&& damage) {
    SkipPointerBvh damaged = layout;
    damage(damaged);
    return find_fault(damaged, hand.scene.geometries(), 1);
  };
  EXPECT_EQ(fault_after([](SkipPointerBvh&) {}), std::nullopt);
  for (const uint32_t wrong : {0U, 1U, 2U, 3U, 5U, 6U, 7U, 8U, 0xFFFFFFFFU}) {
    EXPECT_NE(fault_after([&](SkipPointerBvh& b) { b.nodes[1].first = wrong; }), std::nullopt) << wrong;
  }
  EXPECT_NE(fault_after([](SkipPointerBvh& b) { b.nodes[0].first = 6; }), std::nullopt);
  EXPECT_NE(fault_after([](SkipPointerBvh& b) { b.nodes[2].count = 0; }), std::nullopt);
  EXPECT_NE(fault_after([](SkipPointerBvh& b) { b.nodes[2].first = 3; }), std::nullopt);
  EXPECT_NE(fault_after([](SkipPointerBvh& b) { b.nodes[4].lower.x += 0.5F; }), std::nullopt);
  EXPECT_NE(fault_after([](SkipPointerBvh& b) { b.nodes.pop_back(); }), std::nullopt);
  EXPECT_NE(fault_after([](SkipPointerBvh& b) { b.slots.push_back({0, 0}); }), std::nullopt);
}

class Packets : public testing::Test {
 protected:
  Packets() {
    tracer_.layout = make_bvh2(SevenNodes::bvh());
    tracer_.geometries = hand_.scene.geometries();
  }

  /// Traces in packets of four; each hit is to be that of a single ray.
  TraceCounts counts(const std::vector<Ray>& rays) {
    tracer_.size = 4;
    std::vector<Hit> hits(rays.size()), plain(rays.size());
    TraceCounts counts;
    PacketTracer::table().closest_batch_counted(&tracer_, rays, hits, counts);
    PacketTracer::table().closest_batch(&tracer_, rays, plain);
    for (size_t i = 0; i < rays.size(); ++i) {
      EXPECT_EQ(hits[i], PacketTracer::table().closest(&tracer_, rays[i])) << i;
      EXPECT_EQ(plain[i], hits[i]) << i;
    }
    return counts;
  }

  SevenNodes hand_;
  PacketTracer tracer_;
};

TEST_F(Packets, EqualRaysTestOneBoxForAll) {
  const Ray a = SevenNodes::from_left();
  expect_counts(counts({a}), 3, 1, 7);  // boxes: 0, 1, 3, and twice 4 and 2: the ray, and all at once
  // Nodes and triangles as four single rays; boxes: 0, 1, one for each ray in leaf 3, two each for 4 and 2.
  expect_counts(counts({a, a, a, a}), 12, 4, 10);
  expect_counts(counts({a, a, a, a, a}), 15, 5, 17);  // a packet of four and one of one
}

TEST_F(Packets, TheFirstRayThatEntersLeads) {
  const Ray a = SevenNodes::from_left(), beside = SevenNodes::beside();
  // The root: the first ray misses, not all miss, the second enters. 1; three in leaf 3; two each for 4 and 2, where
  // the limit is that of the rays that came in.
  expect_counts(counts({beside, a, a, a}), 9, 3, 3 + 1 + 3 + 2 + 2);
  expect_counts(counts({beside, beside, beside, beside}), 0, 0, 2);
}

TEST_F(Packets, RaysOfDifferentSignsAreTestedOneByOne) {
  // 0: the first; 1: the first; 3: both; 4: both; 2: both, the second enters; 6 and 5: the second.
  expect_counts(counts({SevenNodes::from_left(), SevenNodes::from_right()}), 9, 4, 10);
}

TEST_F(Packets, RaysThatHitNothingAreLeftOut) {
  const Ray a = SevenNodes::from_left(), invalid{.origin = {0, 0, 0}, .direction = {0, 0, 0}};
  expect_counts(counts({invalid, invalid, invalid, invalid}), 0, 0, 0);
  expect_counts(counts({invalid, a, invalid, a}), 6, 2, 8);
  EXPECT_EQ(counts({}).boxes, 0U);
}

TEST(PacketsOfAnySize, FindWhatSingleRaysFind) {
  const Soup soup;
  Random random(9);
  std::vector<Ray> rays;
  for (int i = 0; i < 1003;
       ++i) {  // bundles from outside, then rays from anywhere to anywhere; no multiple of any size
    const bool bundle = i < 500;
    rays.push_back(
        {.origin = bundle ? Vec3f{20, 1, 2} : 20.0F * random.vector(),
         .direction = bundle ? Vec3f{-20, 0, 0} + 0.01F * static_cast<float>(i) * random.vector() : random.vector()});
    if (i % 7 == 0) rays.back().t_max = 1;
  }
  Scene single;
  single.add({std::span(soup.vertices), std::span(soup.triangles)});
  single.build({.structure = "binned_sah"});
  TraceCounts single_counts;
  std::vector<Hit> expected(rays.size()), hits(rays.size());
  single.closest_hit(rays, expected, single_counts);
  for (const char* size : {"4", "8", "16"}) {
    Scene scene;
    scene.add({std::span(soup.vertices), std::span(soup.triangles)});
    scene.build({.structure = std::string("binned_sah+packets(size=") + size + ")"});
    TraceCounts counts;
    scene.closest_hit(rays, hits, counts);
    EXPECT_EQ(hits, expected) << size;
    scene.closest_hit(rays, hits, 3);
    EXPECT_EQ(hits, expected) << size;
    // Other orders find the nearest hit sooner or later, but the figures are of the same kind.
    EXPECT_NEAR(static_cast<double>(counts.nodes) / static_cast<double>(single_counts.nodes), 1, 0.2) << size;
  }
}

}  // namespace
}  // namespace kerf::test
