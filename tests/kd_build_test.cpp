// The kd-tree's builder against slow and simple ways, its limits, and its options through the whole of a scene.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "kerf/base/error.h"
#include "kerf/build/kd_builder.h"
#include "kerf/build/kd_cell.h"
#include "kerf/build/kd_samples.h"
#include "kerf/scene/scene.h"
#include "tests/support/error_of.h"
#include "tests/support/random.h"
#include "tests/support/random_scene.h"

namespace kerf::test {
namespace {

/// A scene and its references.
struct Input {
  RandomTriangles triangles;
  Geometry geometry;
  std::span<const Geometry> geometries{&geometry, 1};
  std::vector<Reference> references;
  Clipper clipper = geometry_clipper(geometries);

  explicit Input(uint32_t count, uint32_t seed = 1, bool on_grid = false) : triangles(count, seed) {
    if (on_grid) {
      for (Vec3f& v : triangles.vertices) v = {std::round(v.x / 3), std::round(v.y / 3), std::round(v.z / 3)};
    }
    geometry = triangles.geometry();
    references = make_references(geometries).references;
  }
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;

  KdTree build(const KdOptions& options = {}, KdWork* work = nullptr) const {
    KdTree tree = build_kd_tree(references, clipper, options, {}, work);
    mark_repeated(tree, geometries);
    EXPECT_EQ(find_fault(tree, geometries, !options.clips), std::nullopt);
    return tree;
  }
};

KdCell root_of(const std::vector<Reference>& references) {
  KdCell cell;
  for (const Reference& reference : references) cell.bounds.extend(reference.bounds());
  cell.references = references;
  cell.events = make_events(references);
  cell.has_events = true;
  cell.allowed = 1000 * references.size();
  return cell;
}

/// Every side of every box tried, the references counted for each.
KdPlane cheapest_by_trying(const KdCell& cell, const KdCosts& costs) {
  KdPlane best;
  const double area = surface_area(cell.bounds);
  for (uint32_t axis = 0; axis < 3; ++axis) {
    for (const Reference& side : cell.references) {
      for (const float x : {side.lower[axis], side.upper[axis]}) {
        if (!(cell.bounds.lower[axis] < x && x < cell.bounds.upper[axis])) continue;
        for (const bool flat_go_below : {true, false}) {
          size_t below = 0, above = 0;
          for (const Reference& r : cell.references) {
            const bool is_flat = r.lower[axis] == x && r.upper[axis] == x;
            below += r.lower[axis] < x || (is_flat && flat_go_below) ? 1 : 0;
            above += r.upper[axis] > x || (is_flat && !flat_go_below) ? 1 : 0;
          }
          const double share_below = surface_area(below_plane(cell.bounds, axis, x)) / area;
          const double share_above = surface_area(above_plane(cell.bounds, axis, x)) / area;
          double cost = costs.traversal + costs.primitive * (share_below * static_cast<double>(below) +
                                                             share_above * static_cast<double>(above));
          if (below == 0 || above == 0) cost *= 1 - costs.empty_bonus;
          if (cost < best.cost) best = {cost, axis, x, flat_go_below};
        }
      }
    }
  }
  return best;
}

/// Compares a cell's plane with the one by trying all, then its halves' events with fresh ones, and goes down.
size_t compare_below(const KdCell& cell, const Clipper& clipper, uint32_t levels) {
  const KdCosts costs{1, 1, 0.3};
  const KdPlane plane = cheapest_plane(cell.events, cell.references.size(), cell.bounds, costs);
  const KdPlane tried = cheapest_by_trying(cell, costs);
  if (std::isinf(tried.cost)) {
    EXPECT_TRUE(std::isinf(plane.cost));
    return 1;
  }
  EXPECT_NEAR(plane.cost, tried.cost, 1e-9 * tried.cost);
  if (levels == 0) return 1;
  const KdHalves halves = divide(cell, plane, &clipper);
  size_t compared = 1;
  for (const KdCell* half : {&halves.below, &halves.above}) {
    const KdEvents fresh = make_events(half->references);
    for (uint32_t axis = 0; axis < 3; ++axis) {
      const auto same = [](KdEvent a, KdEvent b) { return a.bits == b.bits; };
      EXPECT_TRUE(std::equal(fresh[axis].begin(), fresh[axis].end(), half->events[axis].begin(),
                             half->events[axis].end(), same));
    }
    for (const Reference& r : half->references) EXPECT_TRUE(half->bounds.contains(r.bounds()));
    compared += compare_below(*half, clipper, levels - 1);
  }
  return compared;
}

TEST(KdBuild, TheSweepFindsTheBestOfAllPlanesAndKeepsItsEventsSorted) {
  for (const bool on_grid : {false, true}) {
    const Input input(60, 4, on_grid);
    EXPECT_GT(compare_below(root_of(input.references), input.clipper, 5), 25U);
  }
}

TEST(KdBuild, EventsAreInTheOrderOfASweep) {
  const float positions[] = {-3e30F, -1, -1e-42F, 0, 1e-42F, 1, 3e30F};
  uint64_t last = 0;
  for (const float x : positions) {
    for (const KdEvent::Kind kind : {KdEvent::kEnd, KdEvent::kFlat, KdEvent::kBegin}) {
      for (const uint32_t reference : {0U, 7U, KdEvent::kReferenceMask}) {
        const KdEvent event(x, kind, reference);
        EXPECT_LT(last, event.bits);
        EXPECT_EQ(event.position(), x);
        EXPECT_EQ(event.kind(), kind);
        EXPECT_EQ(event.reference(), reference);
        EXPECT_EQ(event.renumbered(5).bits, KdEvent(x, kind, 5).bits);
        last = event.bits;
      }
    }
  }
}

TEST(KdBuild, ReferencesGoWhereTheirPartsLie) {
  // The first triangle is cut at x = 1, and below it nothing lies above y = 1; the second lies in the plane.
  const std::vector<Vec3f> vertices = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 0, 0}, {1, 1, 0}, {1, 0, 1}};
  const std::vector<TriangleCorners> corners = {{0, 1, 2}, {3, 4, 5}};
  const Geometry geometry{TriangleMesh{std::span(vertices), std::span(corners)}};
  const std::span<const Geometry> geometries(&geometry, 1);
  const Clipper clipper = geometry_clipper(geometries);
  const KdCell root = root_of(make_references(geometries).references);
  for (const bool flat_go_below : {true, false}) {
    const KdHalves halves = divide(root, {0, kX, 1, flat_go_below}, &clipper);
    EXPECT_EQ(halves.below.references.size(), flat_go_below ? 2U : 1U);
    EXPECT_EQ(halves.above.references.size(), flat_go_below ? 1U : 2U);
    EXPECT_NEAR(halves.below.references[0].upper.y, 1, 1e-6);
    EXPECT_EQ(halves.cuts, 1U);
    const KdHalves corner = divide(halves.below, {0, kY, 1.25F, true}, &clipper);
    EXPECT_EQ(corner.above.references.size(), 0U);
    EXPECT_EQ(halves.below.allowed + halves.above.allowed, root.allowed);
  }
}

TEST(KdBuild, CuttingPrimitivesNeedsFewerTestsThanCuttingBoxes) {
  const Input input(3000);
  KdOptions boxes;
  boxes.clips = false;
  // Planes are chosen by what is known of the parts, so the same planes are forced: down the middle to the same depth.
  const std::vector<Reference>& references = input.references;
  std::vector<KdCell> cut{root_of(references)}, whole{root_of(references)};
  for (uint32_t level = 0; level < 9; ++level) {
    const auto halved = [&](const std::vector<KdCell>& cells, const Clipper* clipper) {
      std::vector<KdCell> next;
      for (const KdCell& cell : cells) {
        KdHalves halves = divide(cell, {0, level % 3, center(cell.bounds, level % 3), true}, clipper);
        next.push_back(std::move(halves.below));
        next.push_back(std::move(halves.above));
      }
      return next;
    };
    cut = halved(cut, &input.clipper);
    whole = halved(whole, nullptr);
  }
  size_t cut_references = 0, whole_references = 0;
  for (size_t i = 0; i < cut.size(); ++i) {
    EXPECT_LE(cut[i].references.size(), whole[i].references.size());
    cut_references += cut[i].references.size();
    whole_references += whole[i].references.size();
  }
  EXPECT_LT(1.25 * static_cast<double>(cut_references), static_cast<double>(whole_references));
  input.build(boxes);
}

double cost_of(const std::string& pipeline, const RandomTriangles& triangles) {
  Scene scene;
  scene.add(triangles.geometry());
  return scene.build({.structure = pipeline}).sah_cost;
}

TEST(KdBuild, SampledPlanesAreNearlyAsGoodAsAll) {
  for (const uint32_t seed : {1U, 2U, 3U}) {
    const RandomTriangles triangles(5000, seed);
    const double exact = cost_of("kd_sah", triangles);
    EXPECT_LT(cost_of("kd_sah(build=sampled)", triangles), 1.05 * exact);
    EXPECT_LT(cost_of("kd_sah(build=sampled,samples=2)", triangles), 1.5 * exact);
    EXPECT_LT(1.2 * exact, cost_of("kd_sah(clip=off)", triangles));
  }
}

TEST(KdBuild, SamplesCountAsTryingDoes) {
  for (const bool on_grid : {false, true}) {
    const Input input(200, 5, on_grid);
    const KdCell cell = root_of(input.references);
    const KdCosts costs;
    const KdPlane sampled = cheapest_sampled_plane(cell.references, cell.bounds, costs, 16);
    // What the plane says it costs is what its halves cost.
    const KdHalves halves = divide(cell, sampled, nullptr);
    const double below = surface_area(halves.below.bounds) * static_cast<double>(halves.below.references.size());
    const double above = surface_area(halves.above.bounds) * static_cast<double>(halves.above.references.size());
    EXPECT_NEAR(sampled.cost, 1 + (below + above) / surface_area(cell.bounds), 1e-9 * sampled.cost);
    EXPECT_GE(sampled.cost, (1 - 1e-9) * cheapest_by_trying(cell, costs).cost * (on_grid ? 1 : 0.99));
  }
}

TEST(KdBuild, ATrialPaysWhereAllIsAslant) {
  // A bundle from corner to corner: no single plane helps, but half of it has an eighth of the box.
  RandomTriangles bundle(0);
  Random random(3);
  for (uint32_t i = 0; i < 400; ++i) {
    const Vec3f corner = 0.02F * random.vector();
    bundle.vertices.insert(bundle.vertices.end(),
                           {corner + Vec3f{-1, -1, -1}, corner + Vec3f{1, 1, 1}, corner + Vec3f{0.02F, 0, 0}});
    bundle.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  EXPECT_EQ(cost_of("kd_sah(trial=off)", bundle), 400);
  EXPECT_LT(cost_of("kd_sah", bundle), 100);
}

TEST(KdBuild, WorkGrowsAsNLogN) {
  KdOptions options;
  options.tries = false;
  double first = 0;
  for (const uint32_t count : {1000U, 4000U, 16000U, 64000U}) {
    // Of equal density, so that the trees look alike but for their size.
    RandomTriangles triangles(count, 1, 0);
    const float side = std::cbrt(static_cast<float>(count));
    for (uint32_t i = 0; i < count; ++i) {
      const Vec3f corner = triangles.vertices[size_t{3} * i];
      for (uint32_t k = 0; k < 3; ++k) {
        Vec3f& v = triangles.vertices[size_t{3} * i + k];
        v = v - corner + side * corner;
      }
    }
    const Geometry geometry = triangles.geometry();
    const std::span<const Geometry> geometries(&geometry, 1);
    KdWork work;
    build_kd_tree(make_references(geometries).references, geometry_clipper(geometries), options, {}, &work);
    const double per = static_cast<double>(work.events) / (count * std::log2(count));
    if (first == 0) first = per;
    EXPECT_LT(per, 1.3 * first) << count;
    EXPECT_LT(per, 40) << count;
  }
}

TEST(KdBuild, TheCapIsKept) {
  const Input input(2000);
  for (const double cap : {1.0, 1.2, 1.5}) {
    KdOptions options;
    options.cap = cap;
    EXPECT_LE(static_cast<double>(input.build(options).slots.size()), cap * 2000);
    options.clips = false;
    EXPECT_LE(static_cast<double>(input.build(options).slots.size()), cap * 2000);
  }
  EXPECT_GT(input.build().slots.size(), 3100U);
}

TEST(KdBuild, DepthAndLeafSizeAreKept) {
  const Input input(1000);
  for (const uint32_t depth : {1U, 3U, 10U}) {
    KdOptions options;
    options.max_depth = depth;
    const KdTree tree = input.build(options);
    EXPECT_EQ(find_fault(tree, input.geometries, false, depth), std::nullopt);
  }
  KdOptions options;
  options.leaf_size = 20;
  const KdTree tree = input.build(options);
  for (uint32_t i = 0; i + 2 < tree.nodes.size(); ++i) {
    const KdNode &node = tree.nodes[i], &below = tree.nodes[i + 1];
    if (node.is_leaf() || !below.is_leaf() || !tree.nodes[node.above()].is_leaf()) continue;
    EXPECT_GT(below.count() + tree.nodes[node.above()].count(), 20U) << i;
  }
  EXPECT_LT(tree.nodes.size(), input.build().nodes.size() / 2);
}

TEST(KdBuild, CoincidentTrianglesMakeOneLeaf) {
  const std::vector<Vec3f> vertices = {{0, 0, 1}, {1, 0.25F, 1.5F}, {0.25F, 1, 2}};
  const std::vector<TriangleCorners> corners(100000, {0, 1, 2});
  const Geometry geometry{TriangleMesh{std::span(vertices), std::span(corners)}};
  const std::span<const Geometry> geometries(&geometry, 1);
  const std::vector<Reference> references = make_references(geometries).references;
  for (const bool is_sampled : {false, true}) {
    KdOptions options;
    options.is_sampled = is_sampled;
    const KdTree tree = build_kd_tree(references, geometry_clipper(geometries), options);
    EXPECT_EQ(tree.nodes.size(), 1U);
    EXPECT_EQ(tree.slots.size(), 100000U);
  }
}

TEST(KdBuild, TooLittleMemoryStopsIt) {
  const Input input(5000);
  WorkMeter meter;
  WorkLimit limit;
  limit.bytes = 100'000;
  limit.meter = &meter;
  const LimitScope scope(&limit);
  error_of(ErrorCode::stopped, [&] { build_kd_tree(input.references, input.clipper, {}, limit); });
  // Enough to begin with, too little for the tree.
  KdOptions sampled;
  sampled.is_sampled = true;
  limit.bytes = 2 * input.references.size() * sizeof(Reference);
  sampled.cap = 1000;
  sampled.max_depth = kMaxDepth;
  sampled.costs.primitive = 1000;
  error_of(ErrorCode::stopped, [&] { build_kd_tree(input.references, input.clipper, sampled, limit); });
}

const char* const kVariants[] = {"kd_sah(mailbox=on)",
                                 "kd_sah(clip=off)",
                                 "kd_sah(clip=off,mailbox=on)",
                                 "kd_sah(build=sampled)",
                                 "kd_sah(build=sampled,samples=1,clip=off)",
                                 "kd_sah(trial=off)",
                                 "kd_sah(depth=2)",
                                 "kd_sah(depth=64,empty_bonus=1)",
                                 "kd_sah(leaf=9)",
                                 "kd_sah(cap=1.5)",
                                 "kd_sah(traversal_cost=0,depth=40)",
                                 "kd_sah(primitive_cost=50)"};

/// Rays from points of the scene or beside it, many of them along axes and within planes.
std::vector<Ray> rays_on_grid(size_t count) {
  Random random(9);
  const auto grid = [&] { return static_cast<float>(random.below(9)) - 4; };
  std::vector<Ray> rays;
  for (size_t i = 0; i < count; ++i) {
    Ray ray{.origin = {grid(), grid(), grid()}, .direction = random.vector()};
    for (uint32_t axis = 0; axis < 3; ++axis) {
      if (i % 3 == 0) ray.direction[axis] = grid();
      if (random.below(3) == 0) ray.direction[axis] = random.below(2) == 0 ? 0.0F : -0.0F;
    }
    if (i % 5 == 0) ray.t_max = 1;
    if (i % 7 == 0) ray.t_min = -2;
    rays.push_back(ray);
  }
  return rays;
}

TEST(KdBuild, EveryOptionGivesTheHitsOfBruteForce) {
  const std::vector<Ray> rays = rays_on_grid(1500);
  for (const bool on_grid : {true, false}) {
    const Input input(400, 6, on_grid);
    Scene brute, scene;
    brute.add(input.geometry);
    brute.build({.structure = "brute_force"});
    scene.add(input.geometry);
    for (const char* variant : kVariants) {
      scene.build({.structure = variant});
      EXPECT_EQ(scene.structure().find_fault(), std::nullopt) << variant;
      for (size_t i = 0; i < rays.size(); ++i) {
        const Hit expected = brute.closest_hit(rays[i]);
        ASSERT_EQ(scene.closest_hit(rays[i]), expected) << variant << " ray " << i;
        ASSERT_EQ(scene.any_hit(rays[i]), static_cast<bool>(expected)) << variant << " ray " << i;
      }
    }
  }
}

TEST(KdBuild, TheMailboxSavesTestsAndChangesNoHit) {
  const RandomTriangles triangles(3000, 2);
  Scene plain, mailbox;
  plain.add(triangles.geometry());
  mailbox.add(triangles.geometry());
  plain.build({.structure = "kd_sah(mailbox=off)"});
  mailbox.build({.structure = "kd_sah(mailbox=on)"});
  EXPECT_EQ(plain.report().tree_hash, mailbox.report().tree_hash);
  TraceCounts without, with;
  for (const Ray& ray : rays_on_grid(2000)) EXPECT_EQ(mailbox.closest_hit(ray, with), plain.closest_hit(ray, without));
  EXPECT_EQ(with.nodes, without.nodes);
  EXPECT_LT(static_cast<double>(with.primitives), 0.95 * static_cast<double>(without.primitives));
}

TEST(KdBuild, IsTheSameForAnyNumberOfThreads) {
  const RandomTriangles triangles(30000);
  Scene scene;
  scene.add(triangles.geometry());
  for (const char* pipeline : {"kd_sah", "kd_sah(build=sampled)", "kd_sah(clip=off,cap=2)"}) {
    const uint64_t one = scene.build({.structure = pipeline, .threads = 1}).tree_hash;
    EXPECT_EQ(scene.build({.structure = pipeline, .threads = 5}).tree_hash, one) << pipeline;
  }
}

}  // namespace
}  // namespace kerf::test
