// Queries over arrays of rays: what single rays find, in the caller's order, whatever happens inside.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "kerf/scene/scene.h"
#include "tests/support/error_of.h"
#include "tests/support/random.h"
#include "tests/support/random_scene.h"
#include "tests/support/structures.h"

namespace kerf::test {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Triangles by the thousand, of which some are large, and things that are none.
struct Things {
  RandomTriangles triangles{3000, 5};
  std::vector<Sphere> spheres;
  std::vector<Parallelogram> parallelograms;

  Things() {
    Random random(5);
    for (int i = 0; i < 50; ++i) {
      spheres.push_back({10.0F * random.vector(), 0.5F});
      parallelograms.push_back({10.0F * random.vector(), random.vector(), random.vector()});
    }
  }
  Scene built(const std::string& structure) const {
    Scene scene;
    scene.add(triangles.geometry());
    scene.add(Strided<Sphere>(spheres.data(), spheres.size()), 1);
    scene.add(Strided<Parallelogram>(parallelograms.data(), parallelograms.size()), 2);
    scene.build({.structure = structure});
    return scene;
  }
};

/// Rays that go together, rays that do not, and all that is odd.
std::vector<Ray> odd_rays(size_t count, uint32_t seed = 3) {
  Random random(seed);
  std::vector<Ray> rays;
  for (size_t i = 0; i < count; ++i) {
    Ray ray{.origin = 15.0F * random.vector(), .direction = random.vector()};
    if (i % 3 == 0) ray.origin = {15, 1, 2};
    if (i % 5 == 0) ray.direction[static_cast<uint32_t>(i / 5 % 3)] = i % 2 == 0 ? 0.0F : -0.0F;
    if (i % 7 == 0) ray.t_max = 10;
    if (i % 11 == 0) ray.t_min = -5;
    if (i % 13 == 0) ray.mask = static_cast<uint32_t>(i / 13 % 4);
    if (i % 17 == 0) ray.direction = {};
    if (i % 19 == 0) ray.origin.y = std::nanf("");
    if (i % 23 == 0) ray.t_min = kInfinity;
    if (i % 29 == 0) ray.origin.x = -1e25F;  // not for fused box tests
    if (i % 31 == 0) ray.direction = 1e-20F * ray.direction;
    if (i % 37 == 0 && i > 0) ray = rays[i - 1];
    if (i % 41 == 0) ray.t_min = ray.t_max = i % 2 == 0 ? 0.0F : -0.0F;
    rays.push_back(ray);
  }
  return rays;
}

void expect_single_hits(const Scene& scene, std::span<const Ray> rays, int threads) {
  std::vector<Hit> hits(rays.size(), Hit{1, 2, 3, 4, 5, 6});
  std::vector<uint8_t> any(rays.size(), 7);
  scene.closest_hit(rays, hits, threads);
  scene.any_hit(rays, any, threads);
  for (size_t i = 0; i < rays.size(); ++i) {
    const Hit hit = scene.closest_hit(rays[i]);
    ASSERT_EQ(hits[i], hit) << i << " of " << rays.size() << ", " << threads << " threads";
    ASSERT_EQ(any[i], hit ? 1 : 0) << i << " of " << rays.size() << ", " << threads << " threads";
  }
}

class BatchOf : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Menu, BatchOf, testing::ValuesIn(traceable_pipelines()),
                         [](const auto& entry) { return test_name(entry.param); });

TEST_P(BatchOf, RaysHitWhatSingleRaysHit) {
  const Things things;
  const Scene scene = things.built(GetParam());
  const std::vector<Ray> rays = odd_rays(1500);
  for (const int threads : {1, 2, 7}) expect_single_hits(scene, rays, threads);
  for (const size_t count : {0U, 1U, 31U, 32U, 33U}) expect_single_hits(scene, std::span(rays).first(count), 1);
}

TEST_P(BatchOf, RaysCountsAreThoseOfItsRays) {
  const Things things;
  const Scene scene = things.built(GetParam());
  const std::vector<Ray> rays = odd_rays(300);
  std::vector<uint8_t> any(rays.size());
  TraceCounts batch, single;
  scene.any_hit(rays, any, batch);
  for (size_t i = 0; i < rays.size(); ++i) ASSERT_EQ(any[i] != 0, scene.any_hit(rays[i], single)) << i;
  EXPECT_EQ(batch.nodes, single.nodes);
  EXPECT_EQ(batch.primitives, single.primitives);
  EXPECT_EQ(batch.boxes, single.boxes);
}

class BatchThroughWideTrees : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Menu, BatchThroughWideTrees, testing::Values("bvh4", "bvh8", "quantised_bvh8"),
                         [](const auto& entry) { return entry.param; });

TEST_P(BatchThroughWideTrees, MayBeOfAnyLength) {
  const Things things;
  const Scene scene = things.built("binned_sah+" + GetParam());
  const std::vector<Ray> rays = odd_rays(9000);
  for (const size_t count : {4095U, 4096U, 4097U, 9000U}) expect_single_hits(scene, std::span(rays).first(count), 1);
  expect_single_hits(scene, rays, 3);
}

/// All rays enter all boxes and hit nothing before the ground: no list has room for that.
TEST_P(BatchThroughWideTrees, GoesThroughBoxesThatOverlap) {
  std::vector<Vec3f> vertices{{-99, -99, -2}, {99, -99, -2}, {0, 99, -2}};
  std::vector<TriangleCorners> triangles{{0, 1, 2}};
  Random random(2);
  for (uint32_t i = 1; i < 4000; ++i) {
    const float z = random.vector().x;
    vertices.insert(vertices.end(), {{-10, -10, z}, {10, -10, -z}, {-10, 10, z}});
    triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  Scene scene;
  scene.add(TriangleMesh{vertices, triangles});
  scene.build({.structure = "object_median+" + GetParam()});
  std::vector<Ray> rays;
  for (uint32_t i = 0; i < 4096; ++i) {
    rays.push_back({.origin = {1, 1 + 1e-3F * static_cast<float>(i), 5}, .direction = {0.01F, 0.01F, -1}});
  }
  std::vector<Hit> hits(rays.size());
  scene.closest_hit(rays, hits, 1);
  for (size_t i = 0; i < rays.size(); i += 16) ASSERT_EQ(hits[i], scene.closest_hit(rays[i])) << i;
  EXPECT_EQ(hits[0].primitive, 0U);
}

TEST_P(BatchThroughWideTrees, HitsASingleLeaf) {
  const std::vector<Vec3f> vertices{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<TriangleCorners> triangles{{0, 1, 2}};
  Scene scene;
  scene.add(TriangleMesh{vertices, triangles});
  scene.build({.structure = "binned_sah+" + GetParam()});
  const std::vector<Ray> rays(100, Ray{.origin = {0.2F, 0.2F, 1}, .direction = {0, 0, -1}});
  expect_single_hits(scene, rays, 1);
  Scene empty;
  empty.build({.structure = "binned_sah+" + GetParam()});
  expect_single_hits(empty, rays, 1);
}

TEST(Batch, OfAnotherLengthIsRefused) {
  const Things things;
  const Scene scene = things.built("binned_sah+bvh8");
  const std::vector<Ray> rays(3);
  std::vector<Hit> hits(2);
  std::vector<uint8_t> any(4);
  TraceCounts counts;
  const std::string two = "batch: 3 rays, but room for 2 results", four = "batch: 3 rays, but room for 4 results";
  EXPECT_EQ(error_of(ErrorCode::invalid_argument, [&] { scene.closest_hit(rays, hits); }), two);
  EXPECT_EQ(error_of(ErrorCode::invalid_argument, [&] { scene.closest_hit(rays, hits, counts); }), two);
  EXPECT_EQ(error_of(ErrorCode::invalid_argument, [&] { scene.any_hit(rays, any); }), four);
  EXPECT_EQ(error_of(ErrorCode::invalid_argument, [&] { scene.any_hit(rays, any, counts); }), four);
}

/// Rays in columns, three of them fields of records.
struct Columns {
  struct Place {
    float x, y, z;
    uint32_t mask;
  };
  std::vector<Place> places;
  std::vector<float> dx, dy, dz, t_min, t_max;

  explicit Columns(std::span<const Ray> rays) {
    for (const Ray& ray : rays) {
      places.push_back({ray.origin.x, ray.origin.y, ray.origin.z, ray.mask});
      dx.push_back(ray.direction.x);
      dy.push_back(ray.direction.y);
      dz.push_back(ray.direction.z);
      t_min.push_back(ray.t_min);
      t_max.push_back(ray.t_max);
    }
  }
  RayColumns rays() const {
    const auto field = [&](const void* first) { return Strided<float>(first, places.size(), sizeof(Place)); };
    const Place* first = places.data();
    return {.origin = {field(&first->x), field(&first->y), field(&first->z)},
            .direction = {dx, dy, dz},
            .t_min = t_min,
            .t_max = t_max,
            .mask = Strided<uint32_t>(&first->mask, places.size(), sizeof(Place))};
  }
};

TEST(Batch, MayComeInColumns) {
  const Things things;
  const std::vector<Ray> rays = odd_rays(5000);
  const Columns columns(rays);
  for (const char* structure : {"binned_sah+bvh8", "kd_sah"}) {
    const Scene scene = things.built(structure);
    std::vector<float> t(rays.size()), u(rays.size()), v(rays.size());
    std::vector<uint32_t> primitive(rays.size()), geometry(rays.size()), instance(rays.size());
    std::vector<uint8_t> any(rays.size());
    for (const int threads : {1, 2}) {
      scene.closest_hit(columns.rays(), {t, u, v, primitive, geometry, instance}, threads);
      scene.any_hit(columns.rays(), any, threads);
      for (size_t i = 0; i < rays.size(); ++i) {
        const Hit hit = scene.closest_hit(rays[i]);
        ASSERT_EQ((Hit{t[i], u[i], v[i], primitive[i], geometry[i], instance[i]}), hit) << structure << " " << i;
        ASSERT_EQ(any[i], hit ? 1 : 0) << structure << " " << i;
      }
    }
  }
}

TEST(Batch, LeavesOutColumnsThatAreEmpty) {
  const Things things;
  const Scene scene = things.built("binned_sah+bvh8");
  const float zero = 0, minus_one = -1;
  std::vector<float> x(100), t(100);
  for (size_t i = 0; i < x.size(); ++i) x[i] = 0.1F * static_cast<float>(i) - 5;
  const auto same = [&](const float& value) { return Strided<float>(&value, x.size(), 0); };
  const RayColumns rays{.origin = {x, same(zero), same(zero)}, .direction = {same(zero), same(zero), same(minus_one)}};
  scene.closest_hit(rays, {.t = t});
  for (size_t i = 0; i < x.size(); ++i) {
    EXPECT_EQ(t[i], scene.closest_hit({.origin = {x[i], 0, 0}, .direction = {0, 0, -1}}).t) << i;
  }
  scene.closest_hit(RayColumns{}, HitColumns{});
}

TEST(Batch, NamesTheColumnOfAnotherLength) {
  const Things things;
  const Scene scene = things.built("binned_sah+bvh8");
  const std::vector<float> three(3), two(2);
  std::vector<float> room(2);
  std::vector<uint8_t> any(2);
  RayColumns rays{.origin = {three, three, three}, .direction = {three, three, three}};
  EXPECT_EQ(error_of(ErrorCode::invalid_argument, [&] { scene.closest_hit(rays, {.u = room}); }),
            "batch: 3 rays, but 2 of u");
  EXPECT_EQ(error_of(ErrorCode::invalid_argument, [&] { scene.any_hit(rays, any); }),
            "batch: 3 rays, but room for 2 results");
  rays.t_max = two;
  EXPECT_EQ(error_of(ErrorCode::invalid_argument, [&] { scene.closest_hit(rays, {}); }),
            "batch: 3 rays, but 2 of t_max");
  rays.direction[1] = {};
  EXPECT_EQ(error_of(ErrorCode::invalid_argument, [&] { scene.any_hit(rays, any); }),
            "batch: 3 rays, but 0 of direction y");
}

}  // namespace
}  // namespace kerf::test
