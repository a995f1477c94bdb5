// Scenes and rays that break ray tracers, through every builder of the menu, plain and split, against brute force.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "kerf/base/error.h"
#include "kerf/geometry/prepared_ray.h"
#include "kerf/scene/scene.h"
#include "tests/support/error_of.h"
#include "tests/support/property.h"
#include "tests/support/random.h"
#include "tests/support/sizes.h"
#include "tests/support/structures.h"

namespace kerf::test {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// Everything that rays can be traced through, plain and with about two references per primitive.
const std::vector<std::string>& structures() {
  static const std::vector<std::string> all = all_pipelines();
  return all;
}

/// Geometries of all kinds over their own memory.
struct Things {
  std::vector<Vec3f> vertices;
  std::vector<TriangleCorners> triangles;
  std::vector<Sphere> spheres;
  std::vector<Parallelogram> parallelograms;

  void add(const Triangle& t) {
    const auto first = static_cast<uint32_t>(vertices.size());
    vertices.insert(vertices.end(), {t.a, t.b, t.c});
    triangles.push_back({first, first + 1, first + 2});
  }
  TriangleMesh mesh() const { return {{vertices.data(), vertices.size()}, {triangles.data(), triangles.size()}}; }
  std::vector<Geometry> geometries() const {
    return {{mesh()},
            {Strided<Sphere>(spheres.data(), spheres.size())},
            {Strided<Parallelogram>(parallelograms.data(), parallelograms.size())}};
  }
};

Scene scene_of(const std::vector<Geometry>& geometries) {
  Scene scene;
  for (const Geometry& geometry : geometries) scene.add(geometry);
  return scene;
}
Scene scene_of(const Things& things) { return scene_of(things.geometries()); }

/// What a ray must hit: every primitive tested by the scalar truth, the closest of all.
Hit expected_hit(const std::vector<Geometry>& geometries, const Ray& ray) {
  const PreparedRay prepared(ray);
  Hit best;
  for (uint32_t g = 0; prepared.valid && g < geometries.size(); ++g) {
    if ((geometries[g].mask & ray.mask) == 0) continue;
    for (uint32_t p = 0; p < primitive_count(geometries[g]); ++p) {
      Crossing c;
      if (find_defect(geometries[g], p) != Defect::none) continue;
      if (!intersect(geometries[g], p, prepared, prepared.t_max, c)) continue;
      const Hit hit{c.t, c.u, c.v, p, g, kNone};
      if (!best || closer(hit, best)) best = hit;
    }
  }
  return best;
}

bool same_bits(const Hit& a, const Hit& b) { return std::memcmp(&a, &b, sizeof(Hit)) == 0; }

/// What came of a comparison: how many rays hit, and the first difference, empty where there is none.
struct Outcome {
  size_t hits = 0;
  std::string difference;
};

/// Builds the scene with every structure; each must give each ray its hit to the bit.
Outcome compare_all(const std::vector<Geometry>& geometries, const std::vector<Ray>& rays, bool skip_invalid = false) {
  Outcome outcome;
  std::vector<Hit> expected;
  for (const Ray& ray : rays) outcome.hits += (expected.emplace_back(expected_hit(geometries, ray))) ? 1 : 0;
  for (const std::string& structure : structures()) {
    Scene scene = scene_of(geometries);
    scene.build({.structure = structure, .skip_invalid = skip_invalid});
    for (size_t i = 0; i < rays.size(); ++i) {
      const Hit hit = scene.closest_hit(rays[i]), &right = expected[i];
      if (same_bits(hit, right) && scene.any_hit(rays[i]) == static_cast<bool>(right)) continue;
      std::ostringstream text;
      text << structure << ", ray " << i << ": t " << hit.t << ", geometry " << hit.geometry << ", primitive "
           << hit.primitive << "; it should be t " << right.t << ", geometry " << right.geometry << ", primitive "
           << right.primitive << "; any_hit " << scene.any_hit(rays[i]);
      outcome.difference = text.str();
      return outcome;
    }
  }
  return outcome;
}

/// The number of hits; a difference is a test failure.
size_t check_all(const std::vector<Geometry>& geometries, const std::vector<Ray>& rays, bool skip_invalid = false) {
  const Outcome outcome = compare_all(geometries, rays, skip_invalid);
  EXPECT_EQ(outcome.difference, "");
  return outcome.hits;
}

const Triangle kTriangle = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
const Ray kAtTriangle{.origin = {0.25F, 0.25F, 0}, .direction = {0, 0, 1}};

TEST(Nasty, NothingThereHitsNothing) {
  const Things empty;
  Things flat;
  for (int i = 0; i < 20; ++i) flat.add({{1, 1, 1}, {2, 2, 2}, {3, 3, 3}});
  flat.spheres.push_back({{0, 0, 1}, 0});
  flat.parallelograms.push_back({{0, 0, 1}, {1, 1, 1}, {2, 2, 2}});
  const std::vector<Ray> rays{kAtTriangle, {.origin = {}, .direction = {1, 1, 1}}};
  EXPECT_EQ(check_all({}, rays), 0U);
  EXPECT_EQ(check_all(empty.geometries(), rays), 0U);
  EXPECT_EQ(check_all(flat.geometries(), rays), 0U);
  Scene scene = scene_of(flat);
  const BuildReport& report = scene.build();
  EXPECT_EQ(report.primitives, 22U);
  EXPECT_EQ(report.degenerate, 22U);
  EXPECT_EQ(report.references, 0U);
  EXPECT_EQ(report.references_per_primitive, 0);
  EXPECT_TRUE(scene.bounds().is_empty());
  EXPECT_EQ(scene.normal(scene.closest_hit(kAtTriangle)), Vec3f{});
}

TEST(Nasty, OnePrimitive) {
  Things one;
  one.add(kTriangle);
  EXPECT_EQ(check_all(one.geometries(), {kAtTriangle, {.origin = {2, 2, 0}, .direction = {0, 0, 1}}}), 1U);
}

TEST(Nasty, ManyIdenticalTrianglesHitTheFirst) {
  Things heap;
  heap.vertices = {kTriangle.a, kTriangle.b, kTriangle.c};
  heap.triangles.assign(kManyCoincident, {0, 1, 2});
  for (const std::string& structure : structures()) {
    Scene scene = scene_of(heap);
    EXPECT_LE(scene.build({.structure = structure}).depth, 64U) << structure;
    EXPECT_EQ(scene.closest_hit(kAtTriangle).primitive, 0U) << structure;
    EXPECT_EQ(scene.closest_hit(kAtTriangle).t, 1) << structure;
  }
}

TEST(Nasty, WhatIsInvalidIsNamedAndCountedOrSkipped) {
  Things things;
  for (int i = 0; i < 12; ++i) things.add({{0, 0, 1.0F + i}, {1, 0, 1.0F + i}, {0, 1, 1.0F + i}});
  things.vertices[5].z = kNaN;         // of triangle 1
  things.vertices[21].x = -kInfinity;  // of triangle 7
  things.triangles[9][2] = 36;         // one past the end
  things.triangles[10][0] = 0xFFFFFFFF;
  things.spheres = {{{0, 0, 50}, 1}, {{0, 0, kNaN}, 1}, {{0, 0, 60}, -1}};
  things.parallelograms = {{{kInfinity, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 40}, {1, 0, 0}, {0, 1, 0}}};
  for (const std::string& structure : structures()) {
    Scene scene = scene_of(things);
    const std::string text = error_of(ErrorCode::invalid_geometry, [&] { scene.build({.structure = structure}); });
    EXPECT_NE(text.find("geometry 0, triangle 1:"), std::string::npos) << text;
    EXPECT_NE(text.find(" 7 such"), std::string::npos) << text;
    const BuildReport& report = scene.build({.structure = structure, .skip_invalid = true});
    EXPECT_EQ(report.invalid, 7U);
    EXPECT_EQ(report.primitives, 17U);
  }
  std::vector<Ray> rays;
  for (int i = 0; i < 60; ++i) rays.push_back({.origin = {0.25F, 0.25F, 0.5F + i}, .direction = {0, 0, 1}});
  EXPECT_GT(check_all(things.geometries(), rays, true), 40U);
  things.vertices[5].z = 2;
  Scene scene = scene_of(things);
  things.triangles[1][1] = 77;
  const std::string text = error_of(ErrorCode::invalid_geometry, [&] { scene.build(); });
  EXPECT_NE(text.find("vertex number 77 of 36"), std::string::npos) << text;
}

/// Random triangles around the origin, as large as the space that they stand in, and rays through their middle.
void check_at_size(float size, float largest_part, size_t least_hits) {
  Random random(1);
  Things things;
  for (int i = 0; i < 60; ++i) {
    const Vec3f p = size * random.vector();
    const float part = size * std::pow(largest_part, -random.share());
    things.add({p, p + part * random.vector(), p + part * random.vector()});
    if (i % 6 == 0) things.spheres.push_back({size * random.vector(), 0.2F * part});
    if (i % 6 == 1) things.parallelograms.push_back({p, part * random.vector(), part * random.vector()});
  }
  std::vector<Ray> rays;
  for (int i = 0; i < 300; ++i) {
    const Vec3f origin = 1.5F * size * random.vector();
    const Vec3f target = things.vertices[random.below(180)] + (i % 2 == 0 ? 1e-3F * size : 0.0F) * random.vector();
    Vec3f direction = random.vector();
    // Unit-sized where the difference itself is too small or too large for a direction.
    const float length = largest(abs(target - origin));
    if (length > 0 && i % 8 != 0) direction = to_float(to_double(target - origin) / static_cast<double>(length));
    rays.push_back({.origin = origin, .direction = direction});
  }
  EXPECT_GE(check_all(things.geometries(), rays), least_hits) << size;
}

TEST(Nasty, AnySizeFromDenormalToHuge) {
  for (const float size : {1.0F, 1e30F, 1e35F, 1e-20F, 1e-30F, 1e-38F, 1e-40F, 1e-42F}) check_at_size(size, 1, 100);
}

TEST(Nasty, AMillionFoldMixOfSizes) {
  check_at_size(1, 1e6F, 30);
  check_at_size(1e30F, 1e6F, 30);
}

TEST(Nasty, RaysAlongSharedPlanes) {
  // A grid of squares in the three planes of coordinates, so that boxes are flat and share their sides.
  Things things;
  for (int i = -2; i < 2; ++i) {
    for (int j = -2; j < 2; ++j) {
      const auto a = static_cast<float>(i), b = static_cast<float>(j);
      things.add({{a, b, 0}, {a + 1, b, 0}, {a, b + 1, 0}});
      things.add({{a + 1, b + 1, 0}, {a, b + 1, 0}, {a + 1, b, 0}});
      things.add({{0, a, b}, {0, a + 1, b}, {0, a, b + 1}});
      things.parallelograms.push_back({{a, 0, b}, {1, 0, 0}, {0, 0, 1}});
    }
  }
  things.spheres.push_back({{1, 1, 1}, 1});  // touches all three
  std::vector<Ray> rays;
  for (const float x : {-2.0F, -1.0F, -0.0F, 0.0F, 0.5F, 1.0F, 2.0F, 3.0F}) {
    for (const float y : {-2.0F, -0.5F, 0.0F, 1.0F, 2.0F}) {
      for (const float zero : {0.0F, -0.0F}) {
        rays.push_back({.origin = {x, y, -5}, .direction = {zero, zero, 1}});
        rays.push_back({.origin = {5, x, y}, .direction = {-1, zero, zero}});
        rays.push_back({.origin = {y, 5, x}, .direction = {zero, -1, zero}});
        rays.push_back({.origin = {x - 5, y - 5, 0}, .direction = {1, 1, zero}});
        rays.push_back({.origin = {-5, x, y}, .t_min = -kInfinity, .direction = {1, 1e-42F, zero}});
        rays.push_back({.origin = {x, y, 0}, .direction = {zero, 1e-30F, 1}, .t_max = 0});
      }
    }
  }
  EXPECT_GT(check_all(things.geometries(), rays), 100U);
}

TEST(Nasty, EqualDistancesGoToTheSmallestNumber) {
  Things things;
  for (int i = 0; i < 30; ++i) things.add(kTriangle);
  things.parallelograms.assign(10, {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}});
  const auto at_one = Strided<Parallelogram>(things.parallelograms.data(), 10);
  for (const std::string& structure : structures()) {
    Scene scene;
    const uint32_t first = scene.add(at_one, 1);
    const uint32_t second = scene.add(things.mesh(), 2);
    scene.add(at_one, 2);
    scene.build({.structure = structure});
    Ray ray = kAtTriangle;
    EXPECT_EQ(scene.closest_hit(ray).geometry, first);
    EXPECT_EQ(scene.closest_hit(ray).primitive, 0U);
    ray.mask = 2;
    EXPECT_EQ(scene.closest_hit(ray).geometry, second) << "the first is not seen";
    EXPECT_EQ(scene.closest_hit(ray).primitive, 0U);
    ray.mask = 4;
    EXPECT_FALSE(scene.closest_hit(ray));
    EXPECT_FALSE(scene.any_hit(ray));
  }
}

TEST(Nasty, MixedScenesAgreeToTheBit) {
  size_t hits = 0;
  check_property(kManyDraws, [&] {
    Things things;
    // On a coarse grid every second time: many equal boxes, shared planes, ties and shapes without area.
    const bool grid = draw_int(0, 1) == 0;
    const auto point = [&] {
      return grid ? Vec3f{0.F + draw_int(-3, 3), 0.F + draw_int(-3, 3), 0.F + draw_int(-3, 3)} : 3.0F * draw_vector();
    };
    for (int i = draw_int(0, 40); i > 0; --i) things.add({point(), point(), point()});
    for (int i = draw_int(0, 8); i > 0; --i) things.spheres.push_back({point(), grid ? 1.0F : draw_share()});
    for (int i = draw_int(0, 12); i > 0; --i) things.parallelograms.push_back({point(), point(), point()});
    std::vector<Geometry> geometries = things.geometries();
    geometries.push_back(geometries[0]);
    for (Geometry& geometry : geometries) geometry.mask = static_cast<uint32_t>(draw_int(1, 3));
    std::vector<Ray> rays;
    for (int i = 0; i < 20; ++i) {
      Ray& ray = rays.emplace_back(Ray{.origin = point(), .direction = point()});
      ray.t_min = draw_int(0, 3) == 0 ? -draw_share() : 0;
      ray.t_max = draw_int(0, 3) == 0 ? 2 * draw_share() : kInfinity;
      ray.mask = static_cast<uint32_t>(draw_int(1, 3));
    }
    const Outcome outcome = compare_all(geometries, rays);
    RC_ASSERT(outcome.difference == "");
    hits += outcome.hits;
  });
  EXPECT_GT(hits, 3 * kManyDraws);
}

TEST(Nasty, SplittingReallySplits) {
  Random random(2);
  Things things;
  for (int i = 0; i < 300; ++i) things.add({random.vector(), random.vector(), random.vector()});
  Scene scene = scene_of(things);
  const BuildReport& report = scene.build({.structure = "early_split(budget=2)+binned_sah"});
  EXPECT_NEAR(report.references_per_primitive, 2, 0.03);
}

}  // namespace
}  // namespace kerf::test
