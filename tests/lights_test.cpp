// The radiance of a lambertian floor and of a rough metal under lights of each shape, known in closed form or by
// quadrature. The mean over many pixels must lie within three standard errors.

#include "kerf/render/lights.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "kerf/render/frame.h"
#include "tests/support/radiance.h"

namespace kerf {
namespace {

using test::add;
using test::empty_scene;
using test::expect_radiance;
using test::make_light;
using test::make_material;
using test::mean_radiance;
using test::spot;

constexpr double kPi = std::numbers::pi;
constexpr Vec3f kEmission{3, 2, 1};
constexpr float kAlbedo = 0.5F;

const Parallelogram kFloor{{-50, -50, 0}, {100, 0, 0}, {0, 100, 0}};

/// A floor at z = 0, of which the origin is seen.
test::Estimate seen_floor(SceneDescription scene, uint32_t samples = 64, const Material* floor = nullptr) {
  add(scene, kFloor, floor != nullptr ? *floor : make_material(MaterialType::lambertian, {kAlbedo, kAlbedo, kAlbedo}));
  return mean_radiance(std::move(scene), spot({3, -4, 6}, {0, 0, 0}, {0, 0, 1}), samples);
}

Vec3d reflected(double irradiance_over_emission) {
  return to_double(kEmission) * (irradiance_over_emission * kAlbedo / kPi);
}

/// The irradiance at the origin, with +z as normal, under a polygon of unit radiance above the floor (Lambert 1760).
double polygon_irradiance(const std::vector<Vec3d>& corners) {
  double sum = 0;
  for (size_t i = 0; i < corners.size(); ++i) {
    const Vec3d a = normalized(corners[i]), b = normalized(corners[(i + 1) % corners.size()]);
    sum += std::acos(dot(a, b)) * normalized(cross(a, b)).z;
  }
  return std::abs(sum) / 2;
}

const Parallelogram kPanel{{-0.5F, 0.25F, 1}, {2, 0.5F, 0.5F}, {-0.25F, 1.5F, 1}};
const Triangle kSail{{-1, 0.5F, 0.5F}, {1.5F, 0.25F, 2}, {0.5F, 2, 1.5F}};

std::vector<Vec3d> corners_of(const Parallelogram& p) {
  const auto corners = p.corners();
  return {corners.begin(), corners.end()};
}

Mesh mesh_of(const Triangle& t) {
  Mesh mesh;
  mesh.vertices = {t.a, t.b, t.c};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

TEST(Lights, RectangleOverAFloor) {
  SceneDescription scene = empty_scene({0, 0, 0});
  add(scene, kPanel, make_light(kEmission));
  expect_radiance(seen_floor(scene), reflected(polygon_irradiance(corners_of(kPanel))));
}

TEST(Lights, TriangleOverAFloor) {
  SceneDescription scene = empty_scene({0, 0, 0});
  add(scene, mesh_of(kSail), make_light(kEmission));
  expect_radiance(seen_floor(scene),
                  reflected(polygon_irradiance({to_double(kSail.a), to_double(kSail.b), to_double(kSail.c)})));
}

TEST(Lights, SphereOverAFloor) {
  // E = pi L (r / d)^2 cos, as long as all of it is above the floor.
  SceneDescription scene = empty_scene({0, 0, 0});
  add(scene, Sphere{{1, 2, 2}, 0.75F}, make_light(kEmission));
  expect_radiance(seen_floor(scene), reflected(kPi * 0.5625 / 9 * (2 / 3.0)));
}

TEST(Lights, SmallAndFarSphereLikeTheSun) {
  SceneDescription scene = empty_scene({0, 0, 0});
  add(scene, Sphere{{0, 3000, 4000}, 5}, make_light(kEmission));
  expect_radiance(seen_floor(scene), reflected(kPi * 25 / 25e6 * 0.8), 0.001);
}

TEST(Lights, SphereAroundEverythingIsAFurnace) {
  SceneDescription scene = empty_scene({0, 0, 0});
  add(scene, Sphere{{1, 2, 3}, 200}, make_light(kEmission));
  expect_radiance(seen_floor(scene), reflected(kPi));
}

TEST(Lights, ManyOfAllShapesAddUp) {
  SceneDescription scene = empty_scene({0, 0, 0});
  add(scene, kPanel, make_light(kEmission));
  add(scene, Sphere{{-3, -2, 2}, 0.5F}, make_light(kEmission * 4));
  add(scene, mesh_of({{3, 3, 1}, {4, 3, 1}, {3, 4, 2}}), make_light(kEmission * 0.25F));
  const double sum = polygon_irradiance(corners_of(kPanel)) + 4 * kPi * 0.25 / 17 * (2 / std::sqrt(17.0)) +
                     0.25 * polygon_irradiance({{3, 3, 1}, {4, 3, 1}, {3, 4, 2}});
  expect_radiance(seen_floor(scene, 256), reflected(sum));
}

TEST(Lights, LightsWithSkyAddUp) {
  SceneDescription scene = empty_scene({0.5F, 0.5F, 0.5F});
  add(scene, kPanel, make_light(kEmission));
  const double blocked = polygon_irradiance(corners_of(kPanel));
  const double sky = 0.5 * (kPi - blocked) * kAlbedo / kPi;
  expect_radiance(seen_floor(scene, 128), reflected(blocked) + Vec3d{sky, sky, sky});
}

TEST(Lights, BothSidesShine) {
  SceneDescription scene = empty_scene({0, 0, 0});
  Parallelogram turned{kPanel.corner, kPanel.v, kPanel.u};
  add(scene, turned, make_light(kEmission));
  expect_radiance(seen_floor(scene), reflected(polygon_irradiance(corners_of(kPanel))));
}

TEST(Lights, ALambertianThatEmitsIsALightToo) {
  SceneDescription scene = empty_scene({0, 0, 0});
  Material glowing = make_material(MaterialType::lambertian, {0, 0, 0});
  glowing.emission = kEmission;
  add(scene, kPanel, glowing);
  expect_radiance(seen_floor(scene), reflected(polygon_irradiance(corners_of(kPanel))));
}

TEST(Lights, ConstantIsSeenByOtherSurfaces) {
  SceneDescription scene = empty_scene({0, 0, 0});
  add(scene, kPanel, make_material(MaterialType::constant, kEmission));
  expect_radiance(seen_floor(scene, 256), reflected(polygon_irradiance(corners_of(kPanel))), 0.02);
}

TEST(Lights, HiddenOnesShineButAreNotSeen) {
  SceneDescription scene = empty_scene({0.5F, 0.25F, 0});
  add(scene, kPanel, make_light(kEmission), false);
  const Vec3d middle = to_double(kPanel.corner) + to_double(kPanel.u) * 0.5 + to_double(kPanel.v) * 0.5;
  expect_radiance(mean_radiance(scene, spot(middle + Vec3d{0, 0, 5}, middle, {0, 1, 0})), {0.5, 0.25, 0});
  SceneDescription dark = empty_scene({0, 0, 0});
  add(dark, kPanel, make_light(kEmission), false);
  expect_radiance(seen_floor(dark), reflected(polygon_irradiance(corners_of(kPanel))));
}

TEST(Lights, AHiddenMeshIsHiddenWhole) {
  SceneDescription scene = empty_scene({1, 1, 1});
  Mesh mesh = mesh_of({{-9, -9, 1}, {9, -9, 1}, {0, 9, 1}});
  for (uint32_t i = 0; i < 3; ++i) mesh.vertices.push_back(mesh.vertices[i] + Vec3f{0, 0, 1});
  mesh.triangles.push_back({3, 4, 5});
  add(scene, mesh, make_material(MaterialType::constant, {9, 9, 9}), false);
  expect_radiance(mean_radiance(scene, spot({0, 0, 5}, {0, 0, 0})), {1, 1, 1});
}

TEST(Lights, SomethingInBetweenShades) {
  SceneDescription scene = empty_scene({0, 0, 0});
  add(scene, kPanel, make_light(kEmission));
  add(scene, Sphere{{0, 0, 0}, 0.1F}, make_material(MaterialType::lambertian, {0, 0, 0}), false);
  add(scene, kFloor, make_material(MaterialType::lambertian));
  // Seen through the hidden ball that is around it, the point is in full shadow.
  expect_radiance(mean_radiance(std::move(scene), spot({3, -4, 6}, {0, 0, 0}, {0, 0, 1})), {0, 0, 0}, 1);
}

/// The radiance of a rough white metal floor at the origin under the panel, by the midpoint rule over the panel.
double metal_under_panel(double alpha, Vec3d eye) {
  constexpr int kSteps = 1500;
  const Vec3d corner = to_double(kPanel.corner), u = to_double(kPanel.u), v = to_double(kPanel.v);
  const Vec3d normal = cross(u, v);
  const auto lambda = [&](double cosine) {
    const double tangent2 = (1 - cosine * cosine) / (cosine * cosine);
    return (-1 + std::sqrt(1 + alpha * alpha * tangent2)) / 2;
  };
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const Vec3d p = corner + u * ((i + 0.5) / kSteps) + v * ((j + 0.5) / kSteps);
      const double distance2 = dot(p, p);
      const Vec3d light = normalized(p), half = normalized(light + eye);
      const double c2 = half.z * half.z;
      const double d = alpha * alpha / (kPi * std::pow(c2 * (alpha * alpha - 1) + 1, 2));
      const double g = 1 / (1 + lambda(eye.z) + lambda(light.z));
      sum += d * g / (4 * eye.z) * std::abs(dot(normal, light)) / distance2;
    }
  }
  return sum / (double{kSteps} * kSteps);
}

TEST(Lights, RoughMetalUnderAPanelByBothStrategies) {
  const Vec3d eye = normalized(Vec3d{3, -4, 6});
  for (const float roughness : {0.25F, 0.5F, 0.9F}) {
    SceneDescription scene = empty_scene({0, 0, 0});
    add(scene, kPanel, make_light({1, 1, 1}));
    Material metal = make_material(MaterialType::metal);
    metal.roughness = roughness;
    const double expected = metal_under_panel(roughness * roughness, eye);
    const test::Estimate seen = seen_floor(scene, 128, &metal);
    for (uint32_t c = 0; c < 3; ++c) {
      EXPECT_LE(seen.error[c], 0.01 * expected) << roughness;
      EXPECT_NEAR(seen.mean[c], expected, 3 * seen.error[c] + 2e-5 * expected) << roughness;
    }
  }
}

TEST(Lights, UnequalTrianglesOfOneMesh) {
  SceneDescription scene = empty_scene({0, 0, 0});
  Mesh mesh = mesh_of(kSail);
  for (const Vec3f& p : {Vec3f{-3, 0, 1}, Vec3f{-3, 0.5F, 1}, Vec3f{-3, 0, 1.5F}}) mesh.vertices.push_back(p);
  mesh.triangles.push_back({3, 4, 5});
  mesh.triangles.push_back({0, 0, 1});  // flat: no light
  mesh.materials = {0, 1, 0};
  scene.materials = {make_light(kEmission), make_light(kEmission * 50)};
  scene.objects.push_back({mesh, 0, true, ""});
  const double sum = polygon_irradiance({to_double(kSail.a), to_double(kSail.b), to_double(kSail.c)}) +
                     50 * polygon_irradiance({{-3, 0, 1}, {-3, 0.5, 1}, {-3, 0, 1.5}});
  expect_radiance(seen_floor(scene, 256), reflected(sum));
}

TEST(Lights, AFarStrongOneOutOfSightDoesNotDrownANearOne) {
  SceneDescription scene = empty_scene({0, 0, 0});
  add(scene, kPanel, make_light(kEmission));
  add(scene, Sphere{{0, 0, -500}, 20}, make_light({1e4F, 1e4F, 1e4F}));
  expect_radiance(seen_floor(scene, 64), reflected(polygon_irradiance(corners_of(kPanel))), 0.02);
}

TEST(Lights, AreTheSameAtEveryScale) {
  const double expected = polygon_irradiance(corners_of(kPanel)) + 4 * kPi * 0.25 / 17 * (2 / std::sqrt(17.0));
  for (const float scale : {1e-25F, 1e-20F, 1e-8F, 1e10F, 1e17F, 1e20F, 1e31F}) {
    SceneDescription scene = empty_scene({0, 0, 0});
    add(scene, Parallelogram{kPanel.corner * scale, kPanel.u * scale, kPanel.v * scale}, make_light(kEmission));
    add(scene, Sphere{Vec3f{-3, -2, 2} * scale, 0.5F * scale}, make_light(kEmission * 4));
    add(scene, Parallelogram{kFloor.corner * scale, kFloor.u * scale, kFloor.v * scale},
        make_material(MaterialType::lambertian, {kAlbedo, kAlbedo, kAlbedo}));
    // A ball in the way of a third light, whose shadow the point lies in.
    add(scene, Sphere{Vec3f{0, -4, 4} * scale, 0.5F * scale}, make_light(kEmission));
    add(scene, Sphere{Vec3f{0, -2, 2} * scale, 0.75F * scale}, make_material(MaterialType::lambertian, {}));
    SCOPED_TRACE(scale);
    expect_radiance(mean_radiance(std::move(scene), spot(Vec3d{3, 0, 6} * double{scale}, {0, 0, 0}), 256),
                    reflected(expected), 0.02);
  }
}

TEST(Lights, NarrowMetalLobesAreWhatIsSampled) {
  // A lobe of some degrees under a light of the same width: evaluated and drawn must be the same.
  for (const float roughness : {0.033F, 0.04F, 0.1F}) {
    const double alpha = double{roughness} * roughness;
    const Vec3d eye = normalized(Vec3d{3, 0, 6});
    const Vec3d mirrored{-eye.x, 0, eye.z};
    const double radius = alpha;  // at distance 1: the light's angle is half of the lobe's
    // The midpoint rule over the light's disk, in double.
    const auto lambda = [&](double cosine) {
      return (-1 + std::sqrt(1 + alpha * alpha * (1 - cosine * cosine) / (cosine * cosine))) / 2;
    };
    const Vec3d side = normalized(cross(mirrored, Vec3d{0, 1, 0})), up = cross(side, mirrored);
    double sum = 0;
    constexpr int kSteps = 600;
    for (int i = 0; i < kSteps; ++i) {
      const double angle = std::asin(radius) * (i + 0.5) / kSteps;
      for (int j = 0; j < kSteps; ++j) {
        const double phi = 2 * kPi * (j + 0.5) / kSteps;
        const Vec3d light = mirrored * std::cos(angle) + (side * std::cos(phi) + up * std::sin(phi)) * std::sin(angle);
        const Vec3d half = normalized(light + eye);
        const double d =
            alpha * alpha / (kPi * std::pow(half.x * half.x + half.y * half.y + alpha * alpha * half.z * half.z, 2));
        sum += d / (1 + lambda(eye.z) + lambda(light.z)) / (4 * eye.z) * std::sin(angle) *
               (std::asin(radius) / kSteps) * (2 * kPi / kSteps);
      }
    }
    SceneDescription scene = empty_scene({0, 0, 0});
    add(scene, Sphere{to_float(mirrored), static_cast<float>(radius)}, make_light({1, 1, 1}));
    Material metal = make_material(MaterialType::metal);
    metal.roughness = roughness;
    add(scene, kFloor, metal);
    const Camera camera{eye * 5.0, {0, 0, 0}, {0, 1, 0}, 1e-6};
    const test::Estimate seen = mean_radiance(std::move(scene), camera, 256);
    EXPECT_LE(seen.error.x, 0.003 * sum) << roughness;
    EXPECT_NEAR(seen.mean.x, sum, 3 * seen.error.x + 2e-3 * sum) << roughness;
  }
}

/// density() says the same of a drawn point as sample() did.
TEST(Lights, DensityIsThatOfTheSamples) {
  SceneDescription scene = empty_scene({0, 0, 0});
  add(scene, kPanel, make_light({1, 1, 1}));
  add(scene, Sphere{{-3, -2, 2}, 0.5F}, make_light({2, 1, 3}));
  add(scene, mesh_of(kSail), make_light({1, 4, 1}));
  const RenderScene built(std::move(scene));
  const Lights lights(built);
  ASSERT_EQ(lights.size(), 3U);
  const Vec3d from{0.25, -0.5, 0.125};
  uint32_t drawn[3] = {};
  for (uint32_t i = 0; i < 3000; ++i) {
    LightSample sample;
    const auto x = [&](uint32_t prime) { return static_cast<float>(i * prime % 3001) / 3001; };
    ASSERT_TRUE(lights.sample(from, x(17), {x(71), x(1009)}, sample));
    // Which one was drawn shows by its radiance.
    for (uint32_t object = 0; object < 3; ++object) {
      const Vec3d way = sample.point.position - from;
      const bool is_it = sample.radiance == built.material(object, 0).emission;
      if (!is_it) continue;
      ++drawn[object];
      const float density = lights.density(from, sample.direction, std::sqrt(dot(way, way)), sample.point, object, 0);
      ASSERT_NEAR(density / sample.density, 1, 1e-4) << object;
    }
  }
  for (const uint32_t count : drawn) EXPECT_GT(count, 30U);
}

}  // namespace
}  // namespace kerf
