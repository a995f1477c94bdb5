// Radiance known in closed form, for each material. The mean over many pixels must lie within three standard errors.

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "kerf/render/bsdf.h"
#include "kerf/render/fresnel.h"
#include "kerf/render/sampler.h"
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

constexpr Sphere kBall{{0, 0, 0}, 1};

/// A ball in a world that shines alike from everywhere, seen at an angle of 45 degrees and more.
test::Estimate furnace(const Material& material, float radiance = 1, uint32_t samples = 64) {
  SceneDescription scene = empty_scene({radiance, radiance, radiance});
  add(scene, kBall, material);
  return mean_radiance(std::move(scene), spot({0.7, 0, 5}, {0.7, 0, 0}), samples);
}

TEST(Furnace, EmptySceneIsTheBackground) {
  expect_radiance(mean_radiance(empty_scene({0.25F, 0.5F, 2}), spot({0, 0, 5}, {0, 0, 0})), {0.25, 0.5, 2});
}

TEST(Furnace, LambertianIsItsAlbedo) {
  expect_radiance(furnace(make_material(MaterialType::lambertian)), {1, 1, 1});
  expect_radiance(furnace(make_material(MaterialType::lambertian, {0.2F, 0.5F, 0.9F}), 2), {0.4, 1, 1.8});
}

TEST(Furnace, MirrorIsItsAlbedo) {
  expect_radiance(furnace(make_material(MaterialType::mirror, {0.2F, 0.5F, 1})), {0.2, 0.5, 1});
}

TEST(Furnace, SmoothMetalIsItsReflectanceAtThatAngle) {
  // Seen at x = 0.7 the normal is at asin(0.7) to the view.
  const double cosine = std::sqrt(1 - 0.49);
  Vec3d expected;
  const Vec3f albedo{0.2F, 0.5F, 1};
  for (uint32_t c = 0; c < 3; ++c) {
    // The complex index, worked out anew from Gulbrandsen's formulas, and Fresnel's in complex arithmetic.
    const double r = std::min<double>(albedo[c], 0.99999), root = std::sqrt(r);
    const double n = 0.5 * (1 - r) / (1 + r) + 0.5 * (1 + root) / (1 - root);
    const double k = std::sqrt((r * (n + 1) * (n + 1) - (n - 1) * (n - 1)) / (1 - r));
    const std::complex<double> index(n, k), one(1, 0);
    const std::complex<double> inner = std::sqrt(one - (1 - cosine * cosine) / (index * index));
    const auto s = (cosine - index * inner) / (cosine + index * inner);
    const auto p = (index * cosine - inner) / (index * cosine + inner);
    expected[c] = (std::norm(s) + std::norm(p)) / 2;
  }
  test::Estimate seen = furnace(make_material(MaterialType::metal, albedo));
  for (uint32_t c = 0; c < 3; ++c) EXPECT_NEAR(seen.mean[c], expected[c], 2e-5) << c;
}

TEST(Furnace, GlassLosesNothing) {
  for (const float index : {1.0F, 1.33F, 1.5F, 2.4F, 0.7F}) {
    Material glass = make_material(MaterialType::glass);
    glass.refractive_index = index;
    expect_radiance(furnace(glass, 1, 256), {1, 1, 1});
    glass.transmission = 0.4F;  // the rest is lambertian, white too
    expect_radiance(furnace(glass, 1, 256), {1, 1, 1});
  }
}

TEST(Furnace, MetallicMixesMetalAndLambertian) {
  Material mixed = make_material(MaterialType::metal, {0.5F, 0.5F, 0.5F});
  mixed.metallic = 0;
  expect_radiance(furnace(mixed), {0.5, 0.5, 0.5});
  mixed.albedo = {1, 1, 1};
  mixed.metallic = 0.3F;
  expect_radiance(furnace(mixed), {1, 1, 1});
}

TEST(Furnace, ConstantAndLightShowWhatTheyAreInAnyLight) {
  expect_radiance(furnace(make_material(MaterialType::constant, {0.3F, 2, 0.1F})), {0.3F, 2, 0.1F});
  expect_radiance(furnace(make_light({3, 2, 1})), {3, 2, 1});
}

TEST(Furnace, ShowNormalsIsTheNormalAsColour) {
  SceneDescription scene = empty_scene({1, 1, 1});
  add(scene, kBall, make_material(MaterialType::show_normals));
  expect_radiance(mean_radiance(std::move(scene), spot({5, 5, 5}, {0, 0, 0})),
                  Vec3d{0.5, 0.5, 0.5} + Vec3d{1, 1, 1} * (0.5 / std::sqrt(3.0)), 1e-4);
}

TEST(Furnace, InsideAClosedRoomTheEmissionBouncesForEver) {
  // L = e + a L everywhere.
  for (const bool is_sphere : {true, false}) {
    SceneDescription scene = empty_scene({100, 100, 100});  // which must not get in
    Material wall = make_material(MaterialType::lambertian, {0.2F, 0.5F, 0.8F});
    wall.emission = {1, 2, 3};
    if (is_sphere) {
      add(scene, Sphere{{0, 0, 0}, 2}, wall);
    } else {
      for (uint32_t axis = 0; axis < 3; ++axis) {
        for (const float side : {-2.0F, 2.0F}) {
          Parallelogram face{{-2, -2, -2}, {}, {}};
          face.corner[axis] = side;
          face.u[(axis + 1) % 3] = 4;
          face.v[(axis + 2) % 3] = 4;
          add(scene, face, wall);
        }
      }
    }
    expect_radiance(mean_radiance(std::move(scene), {{0.3, 0.2, 0.1}, {1, 0.5, 0.4}, {0, 1, 0}, 60}, 128),
                    {1 / 0.8, 2 / 0.5, 3 / 0.2}, 0.01);
  }
}

/// The share of light that a rough metal reflects, by the midpoint rule over the hemisphere: GGX and Smith's masking
/// written out with tangents, the reflectance of a white metal.
double ggx_albedo(double alpha, double cosine_eye) {
  const Vec3d eye{std::sqrt(1 - cosine_eye * cosine_eye), 0, cosine_eye};
  const auto lambda = [&](double cosine) {
    const double tangent = std::sqrt(1 - cosine * cosine) / cosine;
    return (-1 + std::sqrt(1 + alpha * alpha * tangent * tangent)) / 2;
  };
  // Over half vectors, around which the integrand is smooth: dl = 4 (eye . h) dh.
  constexpr int kSteps = 1000;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double theta = (i + 0.5) / kSteps * std::numbers::pi / 2;
    for (int j = 0; j < kSteps; ++j) {
      const double phi = (j + 0.5) / kSteps * 2 * std::numbers::pi;
      const Vec3d half{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
      const double across = dot(eye, half);
      const double light_z = 2 * across * half.z - eye.z;
      if (across <= 0 || light_z <= 0) continue;
      const double tangent = std::tan(theta), c4 = std::pow(std::cos(theta), 4);
      const double d =
          1 / (std::numbers::pi * alpha * alpha * c4 * std::pow(1 + tangent * tangent / (alpha * alpha), 2));
      const double g = 1 / (1 + lambda(eye.z) + lambda(light_z));
      const double cell = std::sin(theta) * (std::numbers::pi / 2 / kSteps) * (2 * std::numbers::pi / kSteps);
      sum += d * g / (4 * eye.z) * 4 * across * cell;
    }
  }
  return sum;
}

TEST(Furnace, RoughWhiteMetalIsTheIntegralOfItsLobe) {
  for (const float roughness : {0.3F, 0.6F, 1.0F}) {
    Material metal = make_material(MaterialType::metal);
    metal.roughness = roughness;
    const double expected = ggx_albedo(roughness * roughness, std::sqrt(1 - 0.49));
    const test::Estimate seen = furnace(metal);
    for (uint32_t c = 0; c < 3; ++c) {
      EXPECT_LE(seen.error[c], 0.003);
      EXPECT_NEAR(seen.mean[c], expected, 3 * seen.error[c] + 1e-5) << roughness;
    }
  }
}

/// Light goes straight through the faces of a thick plate again and again: what arrives is the sum of a series.
TEST(Furnace, PlateOfGlassLetsThroughWhatFresnelSays) {
  Material glass = make_material(MaterialType::glass);
  SceneDescription scene = empty_scene({0, 0, 0});
  add(scene, Parallelogram{{-5, -5, 1}, {10, 0, 0}, {0, 10, 0}}, glass);  // its normal is +z
  add(scene, Parallelogram{{-5, -5, 0}, {0, 10, 0}, {10, 0, 0}}, glass);  // -z
  add(scene, Parallelogram{{-5, -5, -1}, {10, 0, 0}, {0, 10, 0}}, make_light({4, 4, 4}));
  const double reflected = 0.04;
  const double through = (1 - reflected) / (1 + reflected) * 4;
  expect_radiance(mean_radiance(std::move(scene), spot({0, 0, 5}, {0, 0, 0}), 256), {through, through, through});
}

TEST(Furnace, RadianceFromWithinGlassIsSpreadByItsIndexSquared) {
  Material glass = make_material(MaterialType::glass);
  SceneDescription scene = empty_scene({0, 0, 0});
  add(scene, Parallelogram{{-5, -5, 1}, {10, 0, 0}, {0, 10, 0}}, glass);
  add(scene, Parallelogram{{-5, -5, 0}, {10, 0, 0}, {0, 10, 0}}, make_light({9, 9, 9}));
  const double expected = 0.96 * 9 / 2.25;
  expect_radiance(mean_radiance(std::move(scene), spot({0, 0, 5}, {0, 0, 0}), 256), {expected, expected, expected});
}

TEST(Furnace, TintedGlassTintsWhatItLetsThrough) {
  Material glass = make_material(MaterialType::glass, {1, 0.5F, 0});
  glass.refractive_index = 1;  // nothing is reflected, nothing bent
  SceneDescription scene = empty_scene({1, 1, 1});
  add(scene, kBall, glass);
  expect_radiance(mean_radiance(std::move(scene), spot({0.2, 0, 5}, {0.2, 0, 0})), {1, 0.25, 0});
}

TEST(Background, AmbientLightIsAddedForAllButCameraRays) {
  SceneDescription scene = empty_scene({0.5F, 0.5F, 0.5F});
  scene.background.intensity = 2;
  scene.background.ambient = 0.25F;
  expect_radiance(mean_radiance(scene, spot({0, 0, 5}, {0, 0, 0})), {1, 1, 1});
  add(scene, kBall, make_material(MaterialType::lambertian, {0.5F, 0.5F, 0.5F}));
  expect_radiance(mean_radiance(scene, spot({0, 0, 5}, {0, 0, 0})), {0.625, 0.625, 0.625});
  scene.materials[0].type = MaterialType::mirror;
  expect_radiance(mean_radiance(scene, spot({0, 0, 5}, {0, 0, 0})), {0.625, 0.625, 0.625});
}

TEST(Texture, ColoursTheAlbedo) {
  SceneDescription scene = empty_scene({1, 1, 1});
  Mesh mesh;
  mesh.vertices = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  // Red, green / blue, white: the first row is the upper one.
  scene.textures.push_back({2, 2, {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255}});
  Material material = make_material(MaterialType::lambertian, {0.5F, 0.5F, 0.5F});
  material.albedo_texture = 0;
  add(scene, mesh, material);
  const auto expect_at = [&](double x, double y, Vec3d expected) {
    const test::Estimate seen = mean_radiance(scene, spot({x, y, 5}, {x, y, 0}), 4);
    for (uint32_t c = 0; c < 3; ++c) EXPECT_NEAR(seen.mean[c], expected[c], 1e-4) << x << " " << y << " " << c;
  };
  expect_at(-0.5, 0.5, {0.5, 0, 0});
  expect_at(0.5, 0.5, {0, 0.5, 0});
  expect_at(-0.5, -0.5, {0, 0, 0.5});
  expect_at(0.5, -0.5, {0.5, 0.5, 0.5});
  expect_at(0, 0, {0.25, 0.25, 0.25});          // halfway between all four
  expect_at(-0.5, 0, {0.25, 0, 0.25});          // between red and blue
  expect_at(-0.999, 0.5, {0.2505, 0.2495, 0});  // at the border it goes on with the other side
}

}  // namespace
}  // namespace kerf
