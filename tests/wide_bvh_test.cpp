// The wide layouts: the same hits as brute force on every instruction set, the collapse worked by hand, damage that is
// found, and bounds that hold.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "kerf/base/instruction_set.h"
#include "kerf/layout/wide_bvh.h"
#include "kerf/layout/wide_collapse.h"
#include "kerf/scene/scene.h"
#include "kerf/trace/trace_wide.h"
#include "kerf/trace/wide_ray.h"
#include "tests/support/environment.h"
#include "tests/support/error_of.h"
#include "tests/support/hand_tree.h"
#include "tests/support/moving_things.h"
#include "tests/support/sizes.h"

namespace kerf::test {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// A ray to a point on a triangle of the things, `size` across.
Ray ray_at(const MovingThings& things, float size, Random& random) {
  const TriangleCorners k = things.triangles[random.below(static_cast<uint32_t>(things.triangles.size()))];
  const Vec3f a = things.vertices[k[0]], b = things.vertices[k[1]], c = things.vertices[k[2]];
  const float s = random.share(), t = (1 - s) * random.share();
  const Vec3f target = a + s * (b - a) + t * (c - a);
  Ray ray{.origin = target + size * random.vector(), .direction = random.vector()};
  const Vec3f way = target - ray.origin;
  // Of tiny numbers the inverse of the largest is infinite.
  const float longest = largest(abs(way));
  if (longest >= 0x1p-120F) ray.direction = way * (1 / longest);
  return ray;
}

using Change = std::function<void(Ray&, const MovingThings&, float size, Random&)>;

/// Ways to make a ray nasty, each with what it is called.
std::vector<std::pair<std::string, Change>> changes() {
  return {{"as it is", [](Ray&, const MovingThings&, float, Random&) {}},
          {"along an axis",
           [](Ray& ray, const MovingThings&, float, Random& random) {
             const uint32_t axis = random.below(3);
             const float sign = random.below(2) == 0 ? -1.0F : 1.0F;
             ray.direction = {-0.0F, 0, -0.0F};
             ray.direction[axis] = sign;
           }},
          {"a component of zero",
           [](Ray& ray, const MovingThings&, float, Random& random) {
             ray.direction[random.below(3)] = random.below(2) == 0 ? 0 : -0.0F;
           }},
          {"nearly along an axis",
           [](Ray& ray, const MovingThings&, float, Random& random) {
             ray.direction[random.below(3)] *= std::ldexp(1.0F, -static_cast<int>(random.below(60)));
           }},
          {"begins behind", [](Ray& ray, const MovingThings&, float size, Random&) { ray.t_min = -4 * size; }},
          {"ends early",
           [](Ray& ray, const MovingThings&, float size, Random& random) { ray.t_max = size * random.share(); }},
          {"a long direction",
           [](Ray& ray, const MovingThings&, float, Random&) { ray.direction = 1e20F * ray.direction; }},
          {"a short direction",
           [](Ray& ray, const MovingThings&, float, Random&) { ray.direction = 1e-20F * ray.direction; }},
          {"from afar",
           [](Ray& ray, const MovingThings&, float size, Random& random) {
             const float way = 1000 * size * random.share();
             ray.origin = ray.origin - way * ray.direction;
           }},
          {"from very far", [](Ray& ray, const MovingThings&, float size,
                               Random&) { ray.origin = ray.origin - 1e7F * size * ray.direction; }},
          {"from a corner",
           [](Ray& ray, const MovingThings& things, float, Random& random) {
             ray.origin = things.vertices[random.below(static_cast<uint32_t>(things.vertices.size()))];
           }},
          {"in a triangle's plane",
           [](Ray& ray, const MovingThings& things, float, Random& random) {
             const uint32_t first = 3 * random.below(static_cast<uint32_t>(things.triangles.size()));
             ray.origin = things.vertices[first];
             const Vec3f side = things.vertices[first + 1] - ray.origin;
             if (largest(abs(side)) >= 0x1p-100F) ray.direction = side * (1 / largest(abs(side)));
             ray.t_min = -kInfinity;
           }},
          {"some geometries only",
           [](Ray& ray, const MovingThings&, float, Random& random) { ray.mask = 1U << random.below(3); }},
          {"from one of its own crossings",
           [](Ray& ray, const MovingThings&, float, Random&) { ray.t_min = ray.t_max = 1; }}};
}

/// Each geometry is seen by rays with its own bit, and the first by all.
/// With one bit in common: rays that have it need not look at masks, others do.
std::vector<Geometry> masked(std::vector<Geometry> geometries) {
  for (uint32_t i = 1; i < geometries.size(); ++i) geometries[i].mask = 1U << i | 1U << 31;
  return geometries;
}

Hit expected_of(const std::vector<Geometry>& geometries, const Ray& ray) {
  const PreparedRay prepared(ray);
  Hit best;
  for (uint32_t g = 0; prepared.valid && g < geometries.size(); ++g) {
    if ((geometries[g].mask & ray.mask) == 0) continue;
    for (uint32_t p = 0; p < primitive_count(geometries[g]); ++p) {
      Crossing c;
      if (!intersect(geometries[g], p, prepared, prepared.t_max, c)) continue;
      const Hit hit{c.t, c.u, c.v, p, g, kNone};
      if (!best || closer(hit, best)) best = hit;
    }
  }
  return best;
}

struct NastyRays {
  std::vector<Ray> rays;
  std::vector<Hit> expected;
  size_t usual = 0, unusual = 0, hits = 0;
};

NastyRays nasty_rays(const MovingThings& things, const std::vector<Geometry>& geometries, const Box3f& bounds,
                     float size, size_t of_each) {
  NastyRays all;
  Random random(11);
  const float largest_coordinate = largest(max(abs(bounds.lower), abs(bounds.upper)));
  for (const auto& [name, change] : changes()) {
    for (size_t i = 0; i < of_each; ++i) {
      Ray ray = ray_at(things, size, random);
      change(ray, things, size, random);
      all.expected.push_back(expected_of(geometries, ray));
      if (name == "from one of its own crossings") {  // t_min and t_max at the hit itself: a tie at both ends
        ray.t_min = -kInfinity;
        ray.t_max = kInfinity;
        const Hit hit = expected_of(geometries, ray);
        if (hit) ray.t_min = ray.t_max = hit.t;
        all.expected.back() = hit;
      }
      all.rays.push_back(ray);
      all.hits += all.expected.back() ? 1 : 0;
      const WideRay wide(ray, largest_coordinate);
      EXPECT_EQ(wide.valid, PreparedRay(ray).valid) << name << ", size " << size;
      if (wide.valid) wide.is_usual ? ++all.usual : ++all.unusual;
    }
  }
  return all;
}

TEST(WideBvh, TheSameHitsOnEveryInstructionSet) {
  for (const float size : {1e-40F, 1e-30F, 1e-17F, 1e-12F, 1.0F, 1e4F, 1e11F, 1e13F, 1e20F, 1e22F, 1e30F}) {
    const MovingThings things = random_things(120, 3, size);
    const std::vector<Geometry> geometries = masked(things.geometries());
    Scene plain;
    for (const Geometry& geometry : geometries) plain.add(geometry);
    plain.build({.structure = "brute_force"});
    const NastyRays nasty = nasty_rays(things, geometries, plain.bounds(), size, 40);
    EXPECT_GT(nasty.hits, size < 1e-38F ? 10U : nasty.rays.size() / 4) << size;
    // Usual numbers take the one way through boxes, what is too large or too small for it the other.
    if (size >= 1e-17F && size <= 1e4F) {
      EXPECT_GT(nasty.usual, nasty.rays.size() / 2) << size;
    } else {
      EXPECT_GT(nasty.unusual, nasty.rays.size() / 2) << size;
    }
    if (size == 1) {
      EXPECT_GT(nasty.unusual, 20U);
    }
    for (const std::string_view set : instruction_sets()) {
      const ScopedVariable isa("KERF_ISA", std::string(set));
      for (const std::string structure :
           {"brute_force", "binned_sah+bvh4", "binned_sah+bvh8", "early_split(budget=3)+binned_sah+bvh4",
            "spatial_split+bvh8", "lbvh(leaf=1)+bvh8(leaf_cost=0,triangle_cost=10)", "binned_sah(leaf=8)+bvh4",
            "binned_sah+quantised_bvh8", "early_split(budget=3)+ploc+quantised_bvh8"}) {
        Scene scene;
        for (const Geometry& geometry : geometries) scene.add(geometry);
        EXPECT_EQ(scene.build({.structure = structure}).instruction_set, set);
        EXPECT_EQ(scene.structure().find_fault(), std::nullopt) << structure;
        size_t wrong = 0;
        for (size_t i = 0; i < nasty.rays.size() && wrong < 3; ++i) {
          const Hit hit = scene.closest_hit(nasty.rays[i]);
          const bool is_right = hit == nasty.expected[i] && scene.any_hit(nasty.rays[i]) == static_cast<bool>(hit);
          wrong += is_right ? 0 : 1;
          EXPECT_TRUE(is_right) << set << ", " << structure << ", size " << size << ", " << changes()[i / 40].first
                                << ", ray " << i;
        }
      }
    }
  }
}

/// Rays that begin and end on a floor, where its crossing is at zero, whichever sign their ends have.
TEST(WideBvh, EndsOfMinusZeroAreZero) {
  std::vector<Vec3f> vertices;
  std::vector<TriangleCorners> triangles;
  for (uint32_t i = 0; i < 100; ++i) {
    const auto x = static_cast<float>(2 * (i % 10)), y = static_cast<float>(2 * (i / 10));
    for (const Vec3f corner : {Vec3f{x, y, 0}, Vec3f{x + 1, y, 0}, Vec3f{x, y + 1, 0}}) vertices.push_back(corner);
    triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  for (const std::string_view set : instruction_sets()) {
    const ScopedVariable isa("KERF_ISA", std::string(set));
    for (const char* structure : {"brute_force", "binned_sah+bvh4", "binned_sah+bvh8", "binned_sah+quantised_bvh8"}) {
      Scene scene;
      scene.add(TriangleMesh{std::span<const Vec3f>(vertices), std::span<const TriangleCorners>(triangles)});
      scene.build({.structure = structure});
      for (uint32_t i = 0; i < 400; ++i) {
        const float begin = i % 4 < 2 ? 0.0F : -0.0F, end = i % 2 == 0 ? 0.0F : -0.0F;
        const Vec3f corner = vertices[size_t{3} * (i / 4)];
        for (const Vec3f direction : {Vec3f{0.5F, -0.25F, 1}, Vec3f{-0.5F, 0.25F, -1}}) {
          const Ray ray{{corner.x + 0.25F, corner.y + 0.25F, 0}, begin, direction, end};
          EXPECT_EQ(scene.closest_hit(ray).primitive, i / 4) << structure << ", " << set << ", " << begin << " " << end;
          EXPECT_TRUE(scene.any_hit(ray)) << structure << ", " << set << ", " << begin << " " << end;
        }
      }
    }
  }
}

/// The ray begins 2e-12 above a floor, and its hit, worked out in double, is at 2e-16 instead of before its beginning:
/// the same in every structure, so boxes are a little larger than what they hold.
TEST(WideBvh, BoxesHoldHitsThatRoundingMoved) {
  std::vector<Vec3f> vertices = {{255.086548F, 0, 9.84615421F}, {256, 0, 512}, {256, 0, 640}};
  for (int i = 0; i < 20; ++i) {  // some more of the floor, away from the ray
    const auto x = static_cast<float>(20 * i);
    for (const Vec3f corner : {Vec3f{x, 0, -20}, Vec3f{x + 10, 0, -20}, Vec3f{x, 0, -10}}) vertices.push_back(corner);
  }
  std::vector<TriangleCorners> triangles;
  for (uint32_t i = 0; i < vertices.size(); i += 3) triangles.push_back({i, i + 1, i + 2});
  const Ray ray{.origin = {255.786606F, 2.27601054e-12F, 395.13147F},
                .t_min = 0,
                .direction = {-277.175598F, 1475.24622F, -1535.45251F},
                .t_max = 1};
  for (const std::string_view set : instruction_sets()) {
    const ScopedVariable isa("KERF_ISA", std::string(set));
    for (const char* structure : {"brute_force", "lbvh(leaf=1)+bvh4(leaf_cost=0,triangle_cost=10)",
                                  "lbvh(leaf=1)+bvh8(leaf_cost=0,triangle_cost=10)", "lbvh(leaf=1)+quantised_bvh8"}) {
      Scene scene;
      scene.add(TriangleMesh{std::span<const Vec3f>(vertices), std::span<const TriangleCorners>(triangles)});
      scene.build({.structure = structure});
      EXPECT_EQ(scene.closest_hit(ray).primitive, 0U) << structure << ", " << set;
      EXPECT_TRUE(scene.any_hit(ray)) << structure << ", " << set;
    }
  }
}

}  // namespace
}  // namespace kerf::test
