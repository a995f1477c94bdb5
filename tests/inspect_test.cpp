// What kerf inspect says, on scenes where it is known: a sliver over many small triangles, shapes worked by hand, none.

#include "kerf/study/inspect.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "kerf/base/error.h"
#include "kerf/study/inspect_text.h"
#include "tests/support/structures.h"

namespace kerf::test {
namespace {

constexpr Camera kFromAbove{.eye = {0, 0, 20}, .look_at = {0, 0, 0}, .up = {0, 1, 0}, .fov = 45};

/// 2 * side^2 triangles that tile the square [-5, 5]^2 at z = 0.
Mesh floor_of(uint32_t side) {
  Mesh mesh;
  for (uint32_t y = 0; y <= side; ++y) {
    for (uint32_t x = 0; x <= side; ++x) {
      const auto at = [&](uint32_t i) { return -5 + 10 * static_cast<float>(i) / static_cast<float>(side); };
      mesh.vertices.push_back({at(x), at(y), 0});
    }
  }
  for (uint32_t y = 0; y < side; ++y) {
    for (uint32_t x = 0; x < side; ++x) {
      const uint32_t corner = y * (side + 1) + x, above = corner + side + 1;
      mesh.triangles.push_back({corner, corner + 1, above});
      mesh.triangles.push_back({corner + 1, above + 1, above});
    }
  }
  return mesh;
}

Material named(const char* name) {
  Material material;
  material.name = name;
  return material;
}

/// One long thin triangle aslant through the floor, the second of its object after one without area.
SceneDescription floor_with_sliver() {
  SceneDescription scene;
  scene.materials = {named("stone"), named("rope")};
  scene.objects.push_back({floor_of(40), 0, true, "floor.ply"});
  Mesh sliver;
  sliver.vertices = {{-5, -5, -0.5F}, {5, 5, 2}, {5, 4.99F, 2}};
  sliver.triangles = {{0, 1, 1}, {0, 1, 2}};
  scene.objects.push_back({sliver, 1, true, "room.yaml:7:3"});
  return scene;
}

InspectOptions quick() {
  InspectOptions options;
  options.width = 60;
  options.height = 40;
  options.trial = kNoTrial;
  options.build.structure = "binned_sah";
  return options;
}

TEST(Inspect, NamesTheSliverFirst) {
  const Inspection found = inspect(floor_with_sliver(), kFromAbove, quick());
  ASSERT_TRUE(found.is_attributed);
  for (const auto* list : {&found.most_tested, &found.most_wasted}) {
    ASSERT_EQ(list->size(), 10U);
    const InspectedPrimitive& first = list->front();
    EXPECT_EQ(first.object, 1U);
    EXPECT_EQ(first.primitive, 1U);
    EXPECT_EQ(first.kind, "triangle");
    EXPECT_EQ(first.place, "room.yaml:7:3");
    EXPECT_EQ(first.material, "rope");
    EXPECT_EQ(first.corners.size(), 3U);
    EXPECT_EQ(first.corners[0], (Vec3d{-5, -5, -0.5}));
    EXPECT_NEAR(first.longest_edge, std::sqrt(100 + 100 + 6.25), 1e-9);
    EXPECT_GT(first.thinness, 1000);
    EXPECT_LT(first.fill(), 0.01);
    EXPECT_EQ(first.references, 1U);
    EXPECT_GT(first.tests, 10 * first.hits);
    EXPECT_GT(first.tests, found.tests / 20);
  }
  EXPECT_EQ(found.most_tested.back().place, "floor.ply");
  EXPECT_EQ(found.most_tested.back().material, "stone");
}

TEST(Inspect, SharesAddUp) {
  InspectOptions options = quick();
  options.top = 1U << 20;  // all
  const Inspection found = inspect(floor_with_sliver(), kFromAbove, options);
  EXPECT_EQ(found.primary_rays, 2400U);
  uint64_t tests = 0, hits = 0, before = ~uint64_t{0};
  for (const InspectedPrimitive& p : found.most_tested) {
    EXPECT_LE(p.tests, before);
    before = p.tests;
    tests += p.tests;
    hits += p.hits;
  }
  EXPECT_EQ(tests, found.tests);
  EXPECT_EQ(hits, found.hits);
  // Every primary hit sends one ray. The sliver is all that it can hit: the floor is flat, and it starts off it.
  EXPECT_GE(found.hits, found.diffuse_rays);
  EXPECT_LE(found.hits, found.diffuse_rays + found.diffuse_rays / 20);
  double box_area = 0, surface = 0, wasted = 0;
  for (const InspectedPrimitive& p : found.most_wasted) {
    box_area += p.box_area;
    surface += p.surface;
    wasted += p.box_area - p.surface;
  }
  EXPECT_EQ(found.most_wasted.size(), found.report.primitives - found.report.degenerate);
  EXPECT_NEAR(box_area, found.box_area, 1e-9 * box_area);
  EXPECT_NEAR(surface, found.surface, 1e-9 * surface);
  EXPECT_NEAR(wasted, found.top_wasted, 1e-9 * wasted);

  ASSERT_FALSE(found.shares.empty());
  for (const TestShare& share : found.shares) {
    uint64_t sum = 0;
    for (size_t i = 0; i < share.primitives; ++i) sum += found.most_tested[i].tests;
    const double wanted = share.share * static_cast<double>(tests);
    EXPECT_GE(static_cast<double>(sum), wanted);
    EXPECT_LT(static_cast<double>(sum - found.most_tested[share.primitives - 1].tests), wanted) << "one less will do";
  }
  EXPECT_EQ(found.shares.back().primitives, found.most_tested.size());
}

TEST(Inspect, HistogramsAndBytesAddUp) {
  const Inspection found = inspect(floor_with_sliver(), kFromAbove, quick());
  uint64_t leaves = 0, slots = 0;
  for (const uint64_t count : found.leaves_by_depth) leaves += count;
  EXPECT_EQ(leaves, found.report.leaves);
  EXPECT_EQ(found.leaves_by_depth.size(), found.report.depth + 1);
  leaves = 0;
  for (size_t i = 0; i < found.leaves_by_size.size(); ++i) {
    leaves += found.leaves_by_size[i];
    slots += i * found.leaves_by_size[i];
  }
  EXPECT_EQ(leaves, found.report.leaves);
  EXPECT_EQ(slots, found.report.references);
  EXPECT_EQ(found.leaves_by_size.size(), found.report.largest_leaf + 1);
  EXPECT_EQ(found.bytes.vertices, (41 * 41 + 3) * 12U);
  EXPECT_EQ(found.bytes.indices, (3200 + 2) * 12U);
  EXPECT_EQ(found.bytes.slots, 3201 * 8U);
  EXPECT_EQ(found.bytes.slots + found.bytes.nodes, found.report.bytes);
  ASSERT_TRUE(found.overlap);
  EXPECT_GT(*found.overlap, 0);
}

TEST(Inspect, MeasuresShapesAsByHand) {
  SceneDescription scene;
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {3, 0, 0}, {0, 4, 0}};
  mesh.triangles = {{0, 1, 2}};
  scene.objects.push_back({mesh, 0, true, "a"});
  scene.objects.push_back({Sphere{{10, 0, 0}, 2}, 0, true, "b"});
  scene.objects.push_back({Parallelogram{{0, 10, 0}, {2, 0, 0}, {0, 0, 6}}, 0, true, "c"});
  InspectOptions options = quick();
  const Inspection found =
      inspect(scene, {.eye = {5, 5, 60}, .look_at = {5, 5, 0}, .up = {0, 1, 0}, .fov = 30}, options);
  ASSERT_EQ(found.most_wasted.size(), 3U);
  const InspectedPrimitive &sphere = found.most_wasted[0], &triangle = found.most_wasted[1],
                           &flat = found.most_wasted[2];
  EXPECT_EQ(sphere.kind, "sphere");
  EXPECT_EQ(sphere.radius, 2);
  EXPECT_EQ(sphere.longest_edge, 4);
  EXPECT_NEAR(sphere.fill(), std::numbers::pi / 6, 1e-6);
  EXPECT_EQ(triangle.kind, "triangle");
  EXPECT_DOUBLE_EQ(triangle.longest_edge, 5);
  EXPECT_DOUBLE_EQ(triangle.thinness, 25.0 / 12);
  EXPECT_DOUBLE_EQ(triangle.surface, 12);
  EXPECT_DOUBLE_EQ(triangle.box_area, 24);
  EXPECT_EQ(flat.kind, "parallelogram");
  EXPECT_EQ(flat.corners.size(), 4U);
  EXPECT_DOUBLE_EQ(flat.longest_edge, 6);
  EXPECT_DOUBLE_EQ(flat.thinness, 3);
  EXPECT_DOUBLE_EQ(flat.fill(), 1);
  EXPECT_EQ(found.bytes.shapes, sizeof(Sphere) + sizeof(Parallelogram));
  EXPECT_NE(inspection_text(found).find("object 1 (b) sphere (10, 0, 0) radius 2"), std::string::npos);
}

class EveryTracer : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Menu, EveryTracer, testing::ValuesIn(traceable_pipelines()),
                         [](const auto& entry) { return test_name(entry.param); });

// A tracer has to say which primitive it tests: see test_primitive() and TraceCounts::count_primitives().
TEST_P(EveryTracer, TellsWhichPrimitivesItTests) {
  InspectOptions options = quick();
  options.build.structure = GetParam();
  options.top = 1U << 20;
  const Inspection found = inspect(floor_with_sliver(), kFromAbove, options);
  EXPECT_TRUE(found.is_attributed);
  EXPECT_GT(found.tests, 0U);
  for (const InspectedPrimitive& p : found.most_tested) EXPECT_LE(p.hits, p.tests);
}

TEST_P(EveryTracer, EmptySceneHasNothingToSay) {
  InspectOptions options = quick();
  options.build.structure = GetParam();
  const Inspection found = inspect({}, kFromAbove, options);
  EXPECT_EQ(found.tests, 0U);
  EXPECT_TRUE(found.most_tested.empty());
  EXPECT_TRUE(found.most_wasted.empty());
  EXPECT_EQ(findings(found), std::vector<std::string>{"There is nothing to hit."});
  EXPECT_EQ(inspection_text(found), "- There is nothing to hit.\n");
}

TEST(Inspect, BruteForceTestsEveryPrimitiveWithEveryRay) {
  InspectOptions options = quick();
  options.build.structure = "brute_force";
  options.top = 1U << 20;
  const Inspection found = inspect(floor_with_sliver(), kFromAbove, options);
  ASSERT_EQ(found.most_tested.size(), found.report.primitives - found.report.degenerate);
  for (const InspectedPrimitive& p : found.most_tested) EXPECT_EQ(p.tests, found.primary_rays + found.diffuse_rays);
  EXPECT_EQ(found.overlap, 0);
}

TEST(Inspect, IsTheSameForAnyNumberOfThreads) {
  InspectOptions options = quick();
  options.width = options.height = 150;  // enough for several stretches of rays
  options.build.threads = 1;
  const Inspection one = inspect(floor_with_sliver(), kFromAbove, options);
  for (const int threads : {2, 7}) {
    options.build.threads = threads;
    const Inspection many = inspect(floor_with_sliver(), kFromAbove, options);
    EXPECT_EQ(many.tests, one.tests);
    EXPECT_EQ(many.hits, one.hits);
    EXPECT_EQ(many.costs.nodes, one.costs.nodes);
    EXPECT_EQ(many.overlap, one.overlap);
    EXPECT_EQ(many.typical_costly.thinness, one.typical_costly.thinness);
    ASSERT_EQ(many.most_tested.size(), one.most_tested.size());
    for (size_t i = 0; i < one.most_tested.size(); ++i) {
      EXPECT_EQ(many.most_tested[i].primitive, one.most_tested[i].primitive);
      EXPECT_EQ(many.most_tested[i].tests, one.most_tested[i].tests);
    }
  }
}

TEST(Inspect, TriesSplittingWhereThereIsNoneAndNoneWhereThereIs) {
  InspectOptions options = quick();
  options.trial = kAutomaticTrial;
  const Inspection plain = inspect(floor_with_sliver(), kFromAbove, options);
  ASSERT_TRUE(plain.trial);
  EXPECT_GT(plain.trial->report.references_per_primitive, 1);
  EXPECT_GT(plain.trial->split, 0U);
  EXPECT_LT(plain.trial->costs.primitives, plain.costs.primitives);
  ASSERT_TRUE(plain.trial->overlap);
  EXPECT_LT(*plain.trial->overlap, *plain.overlap);
  EXPECT_NE(findings(plain).back().find("early_split(sa_max=auto)"), std::string::npos);
  options.build.structure = "early_split(budget=2)+binned_sah";
  const Inspection split = inspect(floor_with_sliver(), kFromAbove, options);
  ASSERT_TRUE(split.trial);
  EXPECT_EQ(split.trial->report.references_per_primitive, 1);
  EXPECT_EQ(split.trial->split, 0U);
  EXPECT_DOUBLE_EQ(split.trial->costs.primitives, plain.costs.primitives);
  options.trial = options.build.structure;
  EXPECT_FALSE(inspect(floor_with_sliver(), kFromAbove, options).trial) << "it is what is inspected";
}

TEST(Inspect, SaysSoWhereNothingIsKnown) {
  const Camera away{.eye = {0, 0, 20}, .look_at = {0, 0, 40}, .up = {0, 1, 0}, .fov = 45};
  const Inspection unseen = inspect(floor_with_sliver(), away, quick());
  EXPECT_EQ(unseen.tests, 0U);
  EXPECT_NE(inspection_text(unseen).find("the camera sees nothing"), std::string::npos);
  EXPECT_EQ(unseen.most_wasted.front().primitive, 1U);
  Inspection silent = inspect(floor_with_sliver(), kFromAbove, quick());
  silent.is_attributed = false;
  silent.most_tested.clear();
  silent.shares.clear();
  EXPECT_NE(inspection_text(silent).find("does not tell which triangles it tests"), std::string::npos);
  InspectOptions hasty = quick();
  hasty.overlap_seconds = -1;
  EXPECT_FALSE(inspect(floor_with_sliver(), kFromAbove, hasty).overlap);
}

TEST(Inspect, TextNamesTheSliver) {
  const std::string text = inspection_text(inspect(floor_with_sliver(), kFromAbove, quick()));
  EXPECT_NE(text.find("object 1 (room.yaml:7:3) 'rope' (-5, -5, -0.5) (5, 5, 2) (5, 4.99, 2)"), std::string::npos)
      << text;
  EXPECT_NE(text.find("The 10 most tested of 3,201 triangles (0.3 %) cost"), std::string::npos) << text;
}

TEST(Inspect, RefusesWhatItCannotDo) {
  InspectOptions options = quick();
  options.trial = "binned_sa";
  EXPECT_THROW(inspect(floor_with_sliver(), kFromAbove, options), Error);
  options = quick();
  options.build.structure = "nothing";
  EXPECT_THROW(inspect(floor_with_sliver(), kFromAbove, options), Error);
  options = quick();
  options.width = options.height = 5000;
  EXPECT_THROW(inspect(floor_with_sliver(), kFromAbove, options), Error);
}

}  // namespace
}  // namespace kerf::test
