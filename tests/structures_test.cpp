// Every entry of the menu that rays can be traced through: invariants, coverage, the hits of brute force, limits. An
// entry gets its rows here by being in the menu.

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "kerf/scene/menu.h"
#include "kerf/scene/pipeline.h"
#include "kerf/scene/scene.h"
#include "tests/support/error_of.h"
#include "tests/support/hand_tree.h"
#include "tests/support/random.h"
#include "tests/support/random_scene.h"
#include "tests/support/sizes.h"
#include "tests/support/structure_check.h"
#include "tests/support/structures.h"

namespace kerf::test {
namespace {

/// Triangles, spheres and parallelograms, some of them large.
struct MixedThings {
  RandomTriangles triangles;
  std::vector<Sphere> spheres;
  std::vector<Parallelogram> parallelograms;

  explicit MixedThings(uint32_t count, uint32_t seed = 1) : triangles(count, seed) {
    Random random(seed);
    for (uint32_t i = 0; i < count / 8; ++i) {
      spheres.push_back({10.0F * random.vector(), i % 16 == 0 ? 2.0F : 0.2F});
      parallelograms.push_back(
          {10.0F * random.vector(), random.vector(), (i % 16 == 0 ? 5.0F : 0.5F) * random.vector()});
    }
  }
  std::vector<Geometry> geometries() const {
    return {triangles.geometry(),
            {Strided<Sphere>(spheres.data(), spheres.size())},
            {Strided<Parallelogram>(parallelograms.data(), parallelograms.size())}};
  }
  void add_to(Scene& scene) const {
    for (const Geometry& geometry : geometries()) scene.add(geometry);
  }
};

/// From everywhere to everywhere, some along the axes, some within limits.
std::vector<Ray> mixed_rays(size_t count, uint32_t seed = 7) {
  Random random(seed);
  std::vector<Ray> rays;
  for (size_t i = 0; i < count; ++i) {
    Ray ray{.origin = 15.0F * random.vector(), .direction = random.vector()};
    if (i % 5 == 0) ray.direction[static_cast<uint32_t>(i / 5 % 3)] = 0;
    if (i % 10 == 0) ray.direction[static_cast<uint32_t>((i / 10 + 1) % 3)] = 0;
    if (i % 7 == 0) ray.t_max = 10;
    if (i % 11 == 0) ray.t_min = 5;
    rays.push_back(ray);
  }
  return rays;
}

/// Nodes to be looked at, and nothing to trace rays through.
class NodesAlone : public Structure {
 public:
  explicit NodesAlone(std::vector<NodeView> nodes) : nodes_(std::move(nodes)) {}

  const TraceTable& table() const override { return table_; }
  const void* data() const override { return nullptr; }
  size_t bytes() const override { return 0; }
  uint64_t hash() const override { return 0; }
  std::optional<std::string> find_fault() const override { return std::nullopt; }
  void visit_nodes(const std::function<void(const NodeView&)>& visit) const override {
    for (const NodeView& node : nodes_) visit(node);
  }

 private:
  std::vector<NodeView> nodes_;
  TraceTable table_{};
};

TEST(OuterFaults, TheFirstIsTold) {
  HandScene scene;
  scene.add(1);
  const LeafSlot slot{0, 0};
  const NodeView root{.bounds = inner_node(0, 2, 0).bounds()};
  const NodeView leaf{.bounds = leaf_node(1, 0).bounds(), .depth = 1, .is_leaf = true, .slots = {&slot, 1}};
  NodeView deeper = leaf, outside = leaf, cut = leaf;
  deeper.depth = 3;
  outside.bounds.upper.x = 3;
  cut.bounds.upper.y = 0.5F;
  const auto fault_of = [&](std::vector<NodeView> nodes) {
    return find_outer_fault(NodesAlone(std::move(nodes)), scene.geometries()).value_or("none");
  };
  const std::string jumps = "a node's depth jumps", is_outside = "a child outside its parent's box";
  EXPECT_EQ(fault_of({root, leaf}), "none");
  EXPECT_EQ(fault_of({root, leaf, deeper}), jumps);
  EXPECT_EQ(fault_of({root, leaf, outside}), is_outside);
  EXPECT_EQ(fault_of({root, deeper, leaf, outside}), jumps);
  EXPECT_EQ(fault_of({root, outside, leaf, deeper}), is_outside);
  EXPECT_EQ(fault_of({leaf}), jumps);
  EXPECT_EQ(fault_of({root}), "geometry 0, primitive 0 is in no leaf");
  EXPECT_EQ(fault_of({root, cut}), "geometry 0, primitive 0 reaches out of the leaves that have it");
}

class EveryStructure : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Menu, EveryStructure, testing::ValuesIn(traceable_pipelines()),
                         [](const auto& entry) { return test_name(entry.param); });

TEST_P(EveryStructure, EmptySceneHitsNothing) {
  Scene scene;
  scene.build({.structure = GetParam()});
  EXPECT_FALSE(scene.closest_hit({.origin = {0, 0, 0}, .direction = {0, 0, 1}}));
  EXPECT_FALSE(scene.any_hit({.origin = {0, 0, 0}, .direction = {0, 0, 1}}));
  EXPECT_EQ(scene.structure().find_fault(), std::nullopt);
  EXPECT_EQ(find_outer_fault(scene), std::nullopt);
  EXPECT_EQ(scene.report().references, 0U);
  EXPECT_EQ(scene.report().sah_cost, 0);
}

TEST_P(EveryStructure, KeepsItsInvariantsAndCoversEveryPrimitive) {
  for (const uint32_t count : {1U, 2U, 7U, 2000U}) {
    const MixedThings things(count);
    Scene scene;
    things.add_to(scene);
    scene.build({.structure = GetParam()});
    EXPECT_EQ(scene.structure().find_fault(), std::nullopt) << count;
    EXPECT_EQ(find_outer_fault(scene), std::nullopt) << count;
    EXPECT_GE(scene.report().references_per_primitive, 1);
    EXPECT_GT(scene.report().bytes, 0U);
    EXPECT_TRUE(std::isfinite(scene.report().sah_cost));
    EXPECT_GT(scene.report().sah_cost, 0);
  }
}

TEST_P(EveryStructure, FindsTheHitsOfBruteForceBitForBit) {
  const MixedThings things(2000);
  Scene brute, scene;
  things.add_to(brute);
  things.add_to(scene);
  brute.build({.structure = "brute_force"});
  scene.build({.structure = GetParam()});
  const std::vector<Ray> rays = mixed_rays(4000);
  std::vector<Hit> batch(rays.size()), counted(rays.size());
  scene.closest_hit(rays, batch);
  TraceCounts batch_counts;
  scene.closest_hit(rays, counted, batch_counts);
  size_t hits = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    const Hit expected = brute.closest_hit(rays[i]);
    hits += expected ? 1 : 0;
    TraceCounts counts;
    ASSERT_EQ(scene.closest_hit(rays[i]), expected) << i;
    ASSERT_EQ(scene.closest_hit(rays[i], counts), expected) << i;
    ASSERT_EQ(scene.any_hit(rays[i]), static_cast<bool>(expected)) << i;
    ASSERT_EQ(scene.any_hit(rays[i], counts), static_cast<bool>(expected)) << i;
    ASSERT_EQ(batch[i], expected) << i;
    ASSERT_EQ(counted[i], expected) << i;
    EXPECT_TRUE(!expected || counts.primitives > 0) << i;
  }
  EXPECT_GT(hits, rays.size() / 10);
  EXPECT_GT(batch_counts.primitives, 0U);
}

TEST_P(EveryStructure, IsTheSameForAnyNumberOfThreads) {
  const MixedThings things(kManyThings);
  Scene scene;
  things.add_to(scene);
  const BuildReport one = scene.build({.structure = GetParam(), .threads = 1});
  for (const int threads : {2, 7}) {
    const BuildReport more = scene.build({.structure = GetParam(), .threads = threads});
    EXPECT_EQ(more.tree_hash, one.tree_hash) << threads;
    EXPECT_EQ(more.bytes, one.bytes);
    EXPECT_EQ(more.sah_cost, one.sah_cost);
  }
}

TEST_P(EveryStructure, CoincidentTrianglesAreBounded) {
  // The limit that nothing but testing them all can pass: 1e5 times the same triangle, the first of them is hit.
  const std::vector<Vec3f> vertices = {{0, 0, 1}, {1, 0.25F, 1.5F}, {0.25F, 1, 2}};
  const std::vector<TriangleCorners> triangles(kManyCoincident, {0, 1, 2});
  Scene scene;
  scene.add(TriangleMesh{std::span(vertices), std::span(triangles)});
  const BuildReport& report = scene.build({.structure = GetParam(), .limit = WorkLimit::seconds(60)});
  EXPECT_LE(report.depth, kMaxDepth);
  EXPECT_LE(report.references_per_primitive, 64);
  EXPECT_LE(report.bytes, size_t{2048} * kManyCoincident);
  const Hit hit = scene.closest_hit({.origin = {0.4F, 0.4F, 0}, .direction = {0, 0, 1}});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit.primitive, 0U);
}

/// Runs stages as Scene does, but only stage `limited` under the limit, and no further.
void run_under_limit(const Pipeline& pipeline, size_t limited, const WorkLimit& limit,
                     std::span<const Geometry> geometries) {
  std::vector<Reference> references = make_references(geometries).references;
  Bvh bvh;
  for (size_t i = 0; i <= limited; ++i) {
    const auto& [entry, options] = pipeline.stages[i];
    const WorkLimit allowed = i == limited ? limit : WorkLimit{};
    if (const auto* splitter = std::get_if<const SplitterEntry*>(&entry->entry)) {
      references =
          (*splitter)->split({geometries, references, geometry_clipper(geometries), allowed}, options).references;
    } else if (const auto* builder = std::get_if<const BuilderEntry*>(&entry->entry)) {
      OptionValues all = options;
      if (i + 1 < pipeline.stages.size() && !all.is_set("leaf")) all.set(entry->name, "leaf", 1);  // fits any layout
      bvh = (*builder)->build({references, geometry_clipper(geometries), allowed}, all);
    } else if (const auto* optimiser = std::get_if<const OptimiserEntry*>(&entry->entry)) {
      bvh = (*optimiser)->optimise(bvh, options, allowed);
    } else if (const auto* layout = std::get_if<const LayoutEntry*>(&entry->entry)) {
      (*layout)->make(bvh, {geometries, {}, false, false, allowed}, options);
    } else {
      std::get<const StructureEntry*>(entry->entry)->build({geometries, references, false, false, allowed}, options);
    }
  }
}

TEST_P(EveryStructure, EachStageGivesUpAtItsLimit) {
  const MixedThings things(2000);
  const std::vector<Geometry> geometries = things.geometries();
  const Pipeline pipeline = parse_pipeline(GetParam());
  const std::atomic<bool> cancelled = true;
  WorkLimit unwanted, late, small;
  unwanted.cancelled = &cancelled;
  late.deadline = WorkLimit::Clock::now();
  small.bytes = 1000;
  for (size_t i = 0; i < pipeline.stages.size(); ++i) {
    run_under_limit(pipeline, i, WorkLimit::seconds(60), geometries);
    for (const WorkLimit& limit : {unwanted, late, small}) {
      SCOPED_TRACE(pipeline.stages[i].entry->name);
      error_of(ErrorCode::stopped, [&] { run_under_limit(pipeline, i, limit, geometries); });
    }
  }
}

TEST_P(EveryStructure, AStoppedBuildLeavesTheSceneAsItWas) {
  const MixedThings things(kManyThings);
  Scene scene;
  things.add_to(scene);
  scene.build({.structure = GetParam()});
  const Hit before = scene.closest_hit(mixed_rays(1)[0]);
  const std::atomic<bool> cancelled = true;
  WorkLimit limit;
  limit.cancelled = &cancelled;
  error_of(ErrorCode::stopped, [&] { scene.build({.structure = GetParam(), .limit = limit}); });
  EXPECT_EQ(scene.closest_hit(mixed_rays(1)[0]), before);
}

}  // namespace
}  // namespace kerf::test
