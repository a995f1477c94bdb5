// Trees that follow vertices that move: after a refit every ray hits what brute force hits, split or not.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <string>

#include "kerf/scene/pipeline.h"
#include "kerf/scene/scene.h"
#include "tests/support/error_of.h"
#include "tests/support/moving_things.h"
#include "tests/support/sizes.h"
#include "tests/support/structure_check.h"
#include "tests/support/structures.h"

namespace kerf::test {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

bool can_refit(const std::string& structure) {
  const MenuEntry last = *parse_pipeline(structure).stages.back().entry;
  const auto* layout = std::get_if<const LayoutEntry*>(&last.entry);
  return last.kind != "structure" && (layout == nullptr || (*layout)->refits);
}

/// What of all_pipelines() can, or cannot, be refitted.
std::vector<std::string> pipelines_that(bool can) {
  std::vector<std::string> some;
  for (const std::string& structure : all_pipelines()) {
    if (can_refit(structure) == can) some.push_back(structure);
  }
  return some;
}

using Move = std::function<Vec3f(Vec3f)>;

Vec3f twisted(Vec3f p, double per_unit) {
  const double angle = per_unit * p.y;
  return to_float({std::cos(angle) * p.x - std::sin(angle) * p.z, p.y, std::sin(angle) * p.x + std::cos(angle) * p.z});
}

/// Each with what it is called; `size` is that of the things.
std::vector<std::pair<std::string, Move>> moves(float size) {
  return {{"nothing", [](Vec3f p) { return p; }},
          {"twist", [=](Vec3f p) { return twisted(p, 2.0 / size); }},
          {"turn",
           [](Vec3f p) {
             return Vec3f{0.8F * p.x - 0.6F * p.y, 0.6F * p.x + 0.8F * p.y, p.z};
           }},
          {"mirror and swap axes",
           [](Vec3f p) {
             return Vec3f{-p.y, p.z, p.x};
           }},
          {"far away",
           [=](Vec3f p) {
             return p + Vec3f{1e4F * size, -3e3F * size, 100 * size};
           }},
          {"flat",
           [](Vec3f p) {
             return Vec3f{p.x, 0.25F, p.z};
           }},
          {"to a line",
           [](Vec3f p) {
             return Vec3f{p.x, p.x, p.x};
           }},
          {"to a point",
           [=](Vec3f) {
             return Vec3f{size, size, size};
           }},
          {"tiny", [](Vec3f p) { return 1e-20F * p; }},
          {"huge", [](Vec3f p) { return 1e10F * p; }},
          {"shaken", [=](Vec3f p) {
             const Vec3d q = to_double(p) * (1e3 / size);
             return p + 0.3F * size * to_float({std::sin(q.y), std::sin(q.z), std::sin(q.x)});
           }}};
}

/// From around the things to points on and between them, some along the axes.
std::vector<Ray> rays_at(const MovingThings& things, size_t count, uint32_t seed) {
  Random random(seed);
  Box3f box;
  for (const Vec3f p : things.vertices) box.extend(p);
  const float size = std::max(largest(box.extent()), 0x1p-100F);
  std::vector<Ray> rays;
  for (size_t i = 0; i < count; ++i) {
    const TriangleCorners k = things.triangles[random.below(static_cast<uint32_t>(things.triangles.size()))];
    const float s = random.share(), t = (1 - s) * random.share();
    const Vec3f a = things.vertices[k[0]], b = things.vertices[k[1]], c = things.vertices[k[2]];
    const Vec3f target = a + s * (b - a) + t * (c - a);
    Ray ray{.origin = target + size * random.vector(), .direction = random.vector()};
    const Vec3f way = target - ray.origin;
    if (largest(abs(way)) > 0) ray.direction = way * (1 / largest(abs(way)));
    if (i % 7 == 0) {
      const auto axis = static_cast<uint32_t>(i / 7 % 3);
      ray.origin = target;
      ray.origin[axis] += size;
      ray.direction = {};
      ray.direction[axis] = -1;
    }
    rays.push_back(ray);
  }
  return rays;
}

Scene scene_of(const MovingThings& things, const BuildOptions& options) {
  Scene scene;
  for (const Geometry& geometry : things.geometries()) scene.add(geometry);
  scene.build(options);
  return scene;
}

/// Every ray must get the hit of brute force, to the bit; returns how many hit.
size_t check_hits(const Scene& scene, const std::vector<Ray>& rays, const std::vector<Hit>& expected) {
  size_t hits = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    const Hit hit = scene.closest_hit(rays[i]);
    EXPECT_TRUE(hit == expected[i]) << "ray " << i;
    EXPECT_EQ(scene.any_hit(rays[i]), static_cast<bool>(expected[i])) << "ray " << i;
    hits += hit ? 1 : 0;
  }
  return hits;
}

std::vector<Hit> expected_hits(const MovingThings& things, const std::vector<Ray>& rays) {
  const std::vector<Geometry> geometries = things.geometries();
  std::vector<Hit> hits;
  hits.reserve(rays.size());
  for (const Ray& ray : rays) hits.push_back(expected_hit(geometries, ray));
  return hits;
}

/// Moves, refits and compares, for every way to move and every structure.
void check_moves(const MovingThings& rest, float size, const std::vector<std::string>& structures, size_t least_hits) {
  std::vector<Scene> scenes;
  scenes.reserve(structures.size());
  for (const std::string& structure : structures) {
    scenes.push_back(scene_of(rest, {.structure = structure, .refittable = true}));
  }
  uint32_t seed = 1;
  for (const auto& [name, move] : moves(size)) {
    const MovingThings moved = rest.moved(move);
    const std::vector<Ray> rays = rays_at(moved, 150, seed++);
    const std::vector<Hit> expected = expected_hits(moved, rays);
    const std::vector<Geometry> geometries = moved.geometries();
    Box3f bounds;
    for (const Geometry& geometry : geometries) {
      for (uint32_t i = 0; i < primitive_count(geometry); ++i) bounds.extend(primitive_bounds(geometry, i));
    }
    for (size_t i = 0; i < structures.size(); ++i) {
      SCOPED_TRACE(name + ", " + structures[i]);
      scenes[i].refit(geometries);
      EXPECT_EQ(scenes[i].bounds(), bounds);
      EXPECT_EQ(scenes[i].structure().find_fault(), std::nullopt);
      EXPECT_EQ(find_outer_fault(scenes[i]), std::nullopt);
      const size_t hits = check_hits(scenes[i], rays, expected);
      EXPECT_GE(hits, name == "twist" ? least_hits : 0);
      if (testing::Test::HasFailure()) return;
    }
  }
}

TEST(Refit, EveryTreeHitsWhatBruteForceHitsHoweverThingsMove) {
  check_moves(random_things(400, 1), 10, pipelines_that(true), 100);
}

TEST(Refit, AnySizeFromDenormalToHuge) {
  const std::vector<std::string> some = {"binned_sah",         "early_split(budget=3)+binned_sah",
                                         "spatial_split",      "early_split(budget=3)+binned_sah+bvh8",
                                         "spatial_split+bvh4", "early_split(budget=3)+binned_sah+quantised_bvh8",
                                         "lbvh+quantised_bvh8"};
  for (const float size : {1e-40F, 1e-30F, 1e-10F, 1e5F, 1e20F, 1e22F}) {
    check_moves(random_things(150, 2, size), size, some, 20);
  }
}

TEST(Refit, NeedlesFarFromTheOriginCutIntoMany) {
  MovingThings needles;
  Random random(3);
  for (int i = 0; i < 60; ++i) {
    const Vec3f at = Vec3f{1e4F, -1e4F, 1e4F} + 10.0F * random.vector();
    needles.add({at, at + 20.0F * random.vector(), at + 0.01F * random.vector()});
  }
  check_moves(needles, 10,
              {"early_split(budget=16)+binned_sah", "early_split(budget=16)+lbvh+skip_pointer",
               "early_split(budget=16)+binned_sah+bvh8", "early_split(budget=16)+lbvh+bvh4",
               "early_split(budget=16)+binned_sah+quantised_bvh8"},
              50);
}

TEST(Refit, ThingsInOnePlace) {
  MovingThings heap;
  for (uint32_t i = 0; i < kManyCoincident; ++i) heap.add({{0, 0, 1}, {1, 0, 1}, {0, 1, 1}});
  for (const std::string structure :
       {"binned_sah", "early_split(budget=2)+ploc", "early_split(budget=2)+binned_sah+bvh8",
        "early_split(budget=2)+binned_sah+quantised_bvh8"}) {
    Scene scene = scene_of(heap, {.structure = structure, .refittable = true});
    const MovingThings moved = heap.moved([](Vec3f p) { return p + Vec3f{0, 0, 4}; });
    scene.refit(moved.geometries());
    EXPECT_EQ(scene.structure().find_fault(), std::nullopt);
    const Hit hit = scene.closest_hit({.origin = {0.25F, 0.25F, 0}, .direction = {0, 0, 1}});
    EXPECT_EQ(hit.primitive, 0U);
    EXPECT_EQ(hit.t, 5);
  }
}

TEST(Refit, AnEmptySceneStaysEmpty) {
  Scene scene;
  scene.build({.refittable = true});
  const RefitReport& report = scene.refit();
  EXPECT_EQ(report.growth, 1);
  EXPECT_FALSE(report.should_rebuild);
  EXPECT_TRUE(scene.bounds().is_empty());
  EXPECT_FALSE(scene.closest_hit({.direction = {0, 0, 1}}));
}

TEST(Refit, WithoutAMoveBoxesStayAndTheWayBackIsExact) {
  const MovingThings things = random_things(2000, 4);
  for (const std::string& structure : pipelines_that(true)) {
    SCOPED_TRACE(structure);
    Scene scene = scene_of(things, {.structure = structure, .refittable = true});
    const bool is_split = scene.report().references > scene.report().primitives;
    const uint64_t built = scene.structure().hash();
    const RefitReport first = scene.refit();
    const uint64_t once = scene.structure().hash();
    EXPECT_TRUE(is_split || once == built);
    EXPECT_NEAR(first.growth, 1, is_split ? 1e-3 : 1e-12);
    EXPECT_NEAR(first.sah_cost, scene.structure().cost(), 1e-9 * first.sah_cost);
    EXPECT_EQ(first.bytes > 0, is_split);
    for (const auto& [name, move] : moves(10)) {
      const MovingThings moved = things.moved(move);
      scene.refit(moved.geometries());
    }
    EXPECT_EQ(scene.refit(things.geometries()).growth, first.growth);
    EXPECT_EQ(scene.structure().hash(), once);
  }
}

TEST(Refit, AnyNumberOfThreadsMakesTheSameTree) {
  const MovingThings things = random_things(kManyThings, 5);
  const MovingThings moved = things.moved([](Vec3f p) { return twisted(p, 0.1F); });
  const std::vector<Geometry> geometries = moved.geometries();
  for (const std::string structure : {"early_split(budget=2)+binned_sah", "lbvh+skip_pointer", "spatial_split+packets",
                                      "early_split(budget=2)+binned_sah+bvh8", "lbvh+bvh4", "lbvh+quantised_bvh8"}) {
    Scene scene = scene_of(things, {.structure = structure, .refittable = true});
    const RefitReport one = scene.refit(geometries, 1);
    const uint64_t hash = scene.structure().hash();
    for (const int threads : {2, 7}) {
      Scene other = scene_of(things, {.structure = structure, .threads = threads, .refittable = true});
      const RefitReport& report = other.refit(geometries, threads);
      EXPECT_EQ(other.structure().hash(), hash) << structure;
      EXPECT_EQ(report.sah_cost, one.sah_cost) << structure;
      EXPECT_EQ(report.bytes, one.bytes);
    }
  }
}

TEST(Refit, WhatHadNoAreaIsHitOnceItHasAndTheOtherWayRound) {
  MovingThings rest;
  rest.add({{0, 0, 1}, {1, 1, 1}, {2, 2, 1}});
  rest.add({{0, 0, 2}, {1, 0, 2}, {0, 1, 2}});
  rest.spheres.push_back({{0, 0, 9}, 0});
  rest.parallelograms.push_back({{0, 0, 3}, {1, 1, 0}, {2, 2, 0}});
  for (const std::string& structure : pipelines_that(true)) {
    SCOPED_TRACE(structure);
    MovingThings things = rest;
    const Ray ray{.origin = {0.25F, 0.25F, 0}, .direction = {0, 0, 1}};
    Scene scene = scene_of(things, {.structure = structure, .refittable = true});
    EXPECT_EQ(scene.report().degenerate, 3U);
    EXPECT_EQ(scene.closest_hit(ray).t, 2);
    things.vertices[1] = {1, 0, 1}, things.vertices[2] = {0, 1, 1};
    things.vertices[4] = things.vertices[3];
    scene.refit();
    EXPECT_EQ(scene.closest_hit(ray).t, 1);
    things.vertices[1] = things.vertices[2];
    things.parallelograms[0].u = {1, 0, 0};
    scene.refit();
    EXPECT_EQ(scene.closest_hit(ray).t, 3);
    things.parallelograms[0].u = {};
    things.spheres[0].radius = 1;
    scene.refit();
    EXPECT_EQ(scene.closest_hit(ray).geometry, 1U);
  }
}

TEST(Refit, WhatIsInvalidIsNamedAndNothingChanges) {
  const MovingThings things = random_things(100, 6);
  Scene scene = scene_of(things, {.structure = "early_split(budget=2)+binned_sah", .refittable = true});
  const std::vector<Ray> rays = rays_at(things, 200, 6);
  const std::vector<Hit> expected = expected_hits(things, rays);
  const uint64_t hash = scene.structure().hash();
  MovingThings bad = things;
  bad.vertices[3 * 17 + 2].y = std::numeric_limits<float>::quiet_NaN();
  bad.vertices[3 * 40].x = kInfinity;
  bad.spheres[2].radius = -1;
  const std::vector<Geometry> moved = bad.geometries();
  const std::string text = error_of(ErrorCode::invalid_geometry, [&] { scene.refit(moved); });
  EXPECT_NE(text.find("geometry 0, triangle 17: "), std::string::npos) << text;
  EXPECT_NE(text.find("; 3 such"), std::string::npos) << text;
  EXPECT_EQ(scene.structure().hash(), hash);
  EXPECT_GT(check_hits(scene, rays, expected), 100U);
  bad = things;
  bad.spheres.pop_back();
  const std::vector<Geometry> fewer = bad.geometries();
  error_of(ErrorCode::invalid_argument, [&] { scene.refit(fewer); });
  error_of(ErrorCode::invalid_argument, [&] { scene.refit(std::span(moved).first(2)); });
  std::vector<Geometry> null = things.geometries();
  null[0].shapes = TriangleMesh{{nullptr, 300}, std::get<TriangleMesh>(null[0].shapes).triangles};
  error_of(ErrorCode::invalid_argument, [&] { scene.refit(null); });
  EXPECT_GT(check_hits(scene, rays, expected), 100U);
}

TEST(Refit, WhatTheBuildSkippedStaysOut) {
  MovingThings things = random_things(50, 7);
  things.vertices[3 * 7].x = kInfinity;
  things.triangles[9][1] = 99999;
  Scene scene = scene_of(things, {.structure = "binned_sah", .skip_invalid = true, .refittable = true});
  EXPECT_EQ(scene.refit().left_out, 0U);
  EXPECT_FALSE(scene.refit().should_rebuild);
  things.vertices[3 * 7].x = 0;
  EXPECT_EQ(scene.refit().left_out, 1U);
  EXPECT_TRUE(scene.refit().should_rebuild);
  things.vertices[3 * 8].x = kInfinity;
  const std::string text = error_of(ErrorCode::invalid_geometry, [&] { scene.refit(); });
  EXPECT_NE(text.find("triangle 8: "), std::string::npos) << text;
  EXPECT_NE(text.find("; 1 such"), std::string::npos) << text;
}

TEST(Refit, ATriangleWithAVertexTwiceIsInNoTree) {
  MovingThings things = random_things(50, 7);
  things.triangles[5][1] = things.triangles[5][0];
  Scene scene = scene_of(things, {.structure = "binned_sah", .refittable = true});
  EXPECT_EQ(scene.report().references, scene.report().primitives - 1);
  const MovingThings moved = things.moved([](Vec3f p) { return -p; });
  EXPECT_EQ(scene.refit(moved.geometries()).left_out, 0U);
  things.triangles[5][1] = things.triangles[5][0] + 1;
  EXPECT_EQ(scene.refit(things.geometries()).left_out, 1U);
  EXPECT_TRUE(scene.refit().should_rebuild);
}

TEST(Refit, OnlyWhatWasBuiltForItCanBeRefitted) {
  const MovingThings things = random_things(50, 8);
  Scene scene;
  error_of(ErrorCode::not_built, [&] { scene.refit(); });
  for (const Geometry& geometry : things.geometries()) scene.add(geometry);
  scene.build();
  const std::string text = error_of(ErrorCode::invalid_option, [&] { scene.refit(); });
  EXPECT_NE(text.find("refittable"), std::string::npos) << text;
  for (const std::string& structure : pipelines_that(false)) {
    const std::string name(parse_pipeline(structure).stages.back().entry->name);
    const std::string why =
        error_of(ErrorCode::invalid_option, [&] { scene.build({.structure = structure, .refittable = true}); });
    EXPECT_EQ(why.find(name + ": it cannot be refitted"), 0U) << why;
  }
}

TEST(Refit, TheNextBuildAndTheSceneItselfSeeWhatMoved) {
  const MovingThings things = random_things(300, 9);
  const MovingThings moved = things.moved([](Vec3f p) { return twisted(p, 0.3F); });
  Scene scene = scene_of(things, {.refittable = true});
  scene.refit(moved.geometries());
  const RefitReport refitted = scene.refit();
  const Scene moved_scene = std::move(scene);
  const Scene fresh = scene_of(moved, {});
  EXPECT_EQ(moved_scene.bounds(), fresh.bounds());
  Scene again = scene_of(things, {.refittable = true});
  again.refit(moved.geometries());
  EXPECT_EQ(again.build().sah_cost, fresh.report().sah_cost);
  EXPECT_GT(refitted.sah_cost, fresh.report().sah_cost);
}

TEST(Refit, GrowthTellsAWornTreeFromAGoodOne) {
  MovingThings things = random_things(3000, 10);
  things.spheres.clear();  // they keep their size
  for (const std::string structure : {"binned_sah", "early_split(budget=2)+binned_sah"}) {
    SCOPED_TRACE(structure);
    Scene scene = scene_of(things, {.structure = structure, .refittable = true});
    const auto growth = [&](const MovingThings& now) { return scene.refit(now.geometries()).growth; };
    EXPECT_NEAR(growth(things.moved([](Vec3f p) { return 3.0F * p + Vec3f{7, 0, 0}; })), 1, 2e-3);
    EXPECT_FALSE(scene.refit(things.geometries()).should_rebuild);
    double last = 1.05;
    for (const float turn : {0.2F, 0.5F}) {
      const double now = growth(things.moved([=](Vec3f p) { return twisted(p, turn); }));
      EXPECT_GT(now, last) << turn;
      last = now;
    }
    Random random(11);
    MovingThings scattered = things;
    for (size_t i = 0; i < things.vertices.size(); i += 3) {
      const Vec3f by = 10.0F * random.vector();
      for (size_t k = i; k < i + 3; ++k) scattered.vertices[k] = scattered.vertices[k] + by;
    }
    EXPECT_GT(growth(scattered), 3);
    EXPECT_TRUE(scene.refit().should_rebuild);
  }
}

}  // namespace
}  // namespace kerf::test
