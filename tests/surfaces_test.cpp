// What a point of a surface is to shading: its normals, material, texture coordinates, and where light goes from it.

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

/// A square around the origin in the plane z = 0, seen from +z, all of its normals tilted toward +x.
Mesh tilted_square(double degrees) {
  Mesh mesh;
  mesh.vertices = {{-5, -5, 0}, {5, -5, 0}, {5, 5, 0}, {-5, 5, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  const double angle = degrees * kPi / 180;
  mesh.normals.assign(4, to_float(Vec3d{std::sin(angle), 0, std::cos(angle)}) * 3.0F);
  return mesh;
}

Parallelogram wall(Vec3f corner, Vec3f u, Vec3f v) { return {corner, u, v}; }

TEST(Mirror, SeesWhatLiesInTheMirroredDirection) {
  // From (3, 0, 4) to the origin and on to (-3, 0, 4): a small plate there.
  SceneDescription scene = empty_scene({0, 0, 0});
  add(scene, wall({-9, -9, 0}, {18, 0, 0}, {0, 18, 0}), make_material(MaterialType::mirror, {0.5F, 0.5F, 0.5F}));
  add(scene, wall({-3.01F, -0.01F, 4}, {0.02F, 0, 0}, {0, 0.02F, 0}), make_material(MaterialType::constant, {2, 4, 6}));
  expect_radiance(mean_radiance(scene, spot({3, 0, 4}, {0, 0, 0})), {1, 2, 3});
}

TEST(Mirror, TurnsWithItsShadingNormal) {
  // Tilted by 20 degrees, seen straight on: it shows what lies at 40 degrees.
  SceneDescription scene = empty_scene({0, 0, 0});
  add(scene, tilted_square(20), make_material(MaterialType::mirror));
  const Vec3d at = Vec3d{std::sin(40 * kPi / 180), 0, std::cos(40 * kPi / 180)} * 10.0;
  add(scene, Sphere{to_float(at), 0.05F}, make_material(MaterialType::constant, {1, 2, 3}));
  expect_radiance(mean_radiance(scene, spot({0, 0, 5}, {0, 0, 0})), {1, 2, 3});
}

TEST(Normals, AreInterpolatedByTheirCorners) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  mesh.normals = {{0, 5, 0}, {0, 0, 2}, {1e-30F, 0, 0}};  // of any length
  mesh.normal_corners = {{1, 2, 0}};
  SceneDescription scene = empty_scene({0, 0, 0});
  add(scene, mesh, make_material(MaterialType::show_normals));
  const Vec3d normal = normalized(Vec3d{0, 0, 1} * 0.5 + Vec3d{1, 0, 0} * 0.2 + Vec3d{0, 1, 0} * 0.3);
  const test::Estimate seen = mean_radiance(scene, spot({0.2, 0.3, 5}, {0.2, 0.3, 0}), 4);
  for (uint32_t c = 0; c < 3; ++c) EXPECT_NEAR(seen.mean[c], normal[c] / 2 + 0.5, 1e-5) << c;
}

TEST(Normals, ACornerWithoutOneLeavesTheTriangleFlat) {
  Mesh mesh = tilted_square(20);
  mesh.normal_corners = {{kNone, kNone, kNone}, {0, 2, 3}};
  SceneDescription scene = empty_scene({0, 0, 0});
  add(scene, mesh, make_material(MaterialType::show_normals));
  expect_radiance(mean_radiance(scene, spot({1, -1, 5}, {1, -1, 0}), 4), {0.5, 0.5, 1}, 1e-4);
}

TEST(Normals, SayWhichSideOfGlassIsOutsideWhateverTheWinding) {
  Mesh mesh = tilted_square(0);
  std::swap(mesh.triangles[0][0], mesh.triangles[0][1]);
  std::swap(mesh.triangles[1][0], mesh.triangles[1][1]);
  SceneDescription scene = empty_scene({0, 0, 0});
  add(scene, mesh, make_material(MaterialType::glass));
  add(scene, wall({-50, -50, -1}, {100, 0, 0}, {0, 100, 0}), make_light({9, 9, 9}));
  const double expected = 0.96 * 9 / 2.25;
  expect_radiance(mean_radiance(scene, spot({0, 0, 5}, {0, 0, 0}), 256), {expected, expected, expected});
}

TEST(Normals, NoLightGoesThroughASurfaceByThem) {
  SceneDescription scene = empty_scene({1, 1, 1});
  add(scene, tilted_square(60), make_material(MaterialType::mirror));  // it would reflect to 120 degrees
  expect_radiance(mean_radiance(scene, spot({0, 0, 5}, {0, 0, 0})), {0, 0, 0});
  // A lambertian gets what of its hemisphere is on the geometric side.
  scene.materials[0] = make_material(MaterialType::lambertian, {0.8F, 0.8F, 0.8F});
  const double expected = 0.8 * (1 + std::cos(kPi / 3)) / 2;
  expect_radiance(mean_radiance(scene, spot({0, 0, 5}, {0, 0, 0}), 256), {expected, expected, expected});
}

TEST(Glass, BendsLightBySnellsLaw) {
  // From 45 degrees into glass of 1.5: at depth 1 the ray is tan(asin(sin(45) / 1.5)) further.
  const double sine = std::sqrt(0.5) / 1.5, x = -sine / std::sqrt(1 - sine * sine);
  SceneDescription scene = empty_scene({0, 0, 0});
  add(scene, wall({-50, -50, 0}, {100, 0, 0}, {0, 100, 0}), make_material(MaterialType::glass));
  add(scene, wall({static_cast<float>(x) - 0.001F, -1, -1}, {0.002F, 0, 0}, {0, 2, 0}),
      make_material(MaterialType::constant, {9, 9, 9}));
  const double ci = std::sqrt(0.5), ct = std::sqrt(1 - sine * sine);
  const double p = (1.5 * ci - ct) / (1.5 * ci + ct), s = (ci - 1.5 * ct) / (ci + 1.5 * ct);
  const double expected = (1 - (p * p + s * s) / 2) * 9 / 2.25;
  expect_radiance(mean_radiance(scene, spot({5, 0, 5}, {0, 0, 0}), 64), {expected, expected, expected});
}

TEST(Glass, TransmissionIsTheShareThatGoesThrough) {
  Material pane = make_material(MaterialType::glass, {0.5F, 0.5F, 0.5F});
  pane.refractive_index = 1;
  pane.transmission = 0.4F;
  SceneDescription scene = empty_scene({1, 1, 1});
  add(scene, wall({-5, -5, 0}, {10, 0, 0}, {0, 10, 0}), pane);
  add(scene, wall({-5, -5, -1}, {10, 0, 0}, {0, 10, 0}), make_material(MaterialType::constant, {5, 5, 5}));
  expect_radiance(mean_radiance(scene, spot({0, 0, 5}, {0, 0, 0}), 256), {1.3, 1.3, 1.3});
}

TEST(Mesh, EachTriangleHasItsMaterialAndItsCornersTheirTexture) {
  SceneDescription scene = empty_scene({0, 0, 0});
  Mesh mesh = tilted_square(0);
  mesh.materials = {1, 0};
  mesh.uvs = {{0.25F, 0.25F}, {0.75F, 0.75F}};
  mesh.uv_corners = {{0, 0, 0}, {1, 1, 1}};
  add(scene, mesh, make_material(MaterialType::constant, {1, 2, 3}));
  scene.materials.push_back(make_material(MaterialType::constant, {4, 5, 6}));
  const auto expect_at = [&](double x, double y, Vec3d expected) {
    const test::Estimate seen = mean_radiance(scene, spot({x, y, 5}, {x, y, 0}), 4);
    for (uint32_t c = 0; c < 3; ++c) EXPECT_NEAR(seen.mean[c], expected[c], 1e-6) << x << " " << c;
  };
  expect_at(1, -1, {4, 5, 6});
  expect_at(-1, 1, {1, 2, 3});
  // Lower left blue, upper right green.
  scene.textures.push_back({2, 2, {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255}});
  for (Material& material : scene.materials) material.albedo_texture = 0;
  expect_at(1, -1, {0, 0, 6});
  expect_at(-1, 1, {0, 2, 0});
}

TEST(Sphere, NormalIsRightFromAnyDistance) {
  for (const double distance : {1.5, 1e3, 1e6}) {
    SceneDescription scene = empty_scene({0, 0, 0});
    add(scene, Sphere{{0, 0, 0}, 1}, make_material(MaterialType::show_normals));
    const Camera camera{{0.6, 0, distance}, {0.6, 0, 0}, {0, 1, 0}, 1e-9};
    const test::Estimate seen = mean_radiance(scene, camera, 1);
    EXPECT_NEAR(seen.mean.x, 0.8, 1e-5) << distance;
    EXPECT_NEAR(seen.mean.z, 0.9, 1e-5) << distance;
  }
}

TEST(Pixel, IsTheMeanOverItsArea) {
  // One pixel, of which a plate covers the left quarter.
  SceneDescription scene = empty_scene({0, 0, 0});
  add(scene, wall({-9, -9, 0}, {8.5F, 0, 0}, {0, 18, 0}), make_material(MaterialType::constant, {4, 4, 4}));
  PathTracerOptions options;
  options.width = options.height = 1;
  options.samples = 1024;
  const PathTracerResult result = render_paths(RenderScene(scene), {{0, 0, 1}, {0, 0, 0}, {0, 1, 0}, 90}, options);
  EXPECT_NEAR(result.radiance.pixels[0], 1, 0.01);
}

}  // namespace
}  // namespace kerf
