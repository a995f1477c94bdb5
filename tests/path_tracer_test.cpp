// What a picture depends on, and what it does not.

#include "kerf/render/path_tracer.h"

#include <gtest/gtest.h>

#include <thread>

#include "kerf/base/error.h"
#include "tests/support/radiance.h"
#include "tests/support/structures.h"

namespace kerf {
namespace {

using test::add;
using test::empty_scene;
using test::make_light;
using test::make_material;

/// Every shape, every material, a mesh with normals, lights of all kinds.
SceneDescription mixed_scene() {
  SceneDescription scene = empty_scene({0.2F, 0.3F, 0.5F});
  add(scene, Parallelogram{{-4, 0, -4}, {0, 0, 8}, {8, 0, 0}},
      make_material(MaterialType::lambertian, {0.6F, 0.5F, 0.4F}));
  add(scene, Parallelogram{{-1, 3, -1}, {2, 0, 0}, {0, 0, 2}}, make_light({5, 5, 4}));
  add(scene, Sphere{{2, 2, 1}, 0.3F}, make_light({2, 4, 8}), false);
  add(scene, Sphere{{-1.2F, 0.6F, 0}, 0.6F}, make_material(MaterialType::glass));
  Material metal = make_material(MaterialType::metal, {0.9F, 0.7F, 0.4F});
  metal.roughness = 0.4F;
  metal.metallic = 0.8F;
  add(scene, Sphere{{0.2F, 0.5F, -0.5F}, 0.5F}, metal);
  add(scene, Sphere{{1.4F, 0.4F, 0.4F}, 0.4F}, make_material(MaterialType::mirror, {0.9F, 0.9F, 0.9F}));
  Mesh tent;
  tent.vertices = {{-3, 0, -3}, {-1, 2, -3}, {1, 0, -3}, {3, 2, -3}};
  tent.triangles = {{0, 2, 1}, {1, 2, 3}};
  tent.normals = {{0, 0, 1}, {0.5F, 0, 1}, {-0.5F, 0, 1}, {0, 0.5F, 1}};
  add(scene, tent, make_material(MaterialType::lambertian, {0.3F, 0.8F, 0.3F}));
  return scene;
}

const Camera kCamera{{0.5, 2, 6}, {0, 0.8, 0}, {0, 1, 0}, 45};

Image render(const PathTracerOptions& options, const std::string& structure = "binned_sah") {
  BuildOptions build;
  build.structure = structure;
  PathTracerResult result = render_paths(RenderScene(mixed_scene(), build), kCamera, options);
  EXPECT_TRUE(result.complete);
  EXPECT_EQ(result.invalid, 0U);
  return std::move(result.radiance);
}

PathTracerOptions small(uint32_t samples, uint32_t seed, int threads = 0) {
  PathTracerOptions options;
  options.width = 50;  // no multiple of a tile
  options.height = 37;
  options.samples = samples;
  options.seed = seed;
  options.threads = threads;
  return options;
}

TEST(PathTracer, SameBitsForAnyNumberOfThreads) {
  const Image one = render(small(11, 3, 1));
  for (const int threads : {2, 3, 7}) EXPECT_EQ(one.pixels, render(small(11, 3, threads)).pixels) << threads;
  EXPECT_EQ(one.pixels, render(small(11, 3, 2)).pixels) << "again";
}

TEST(PathTracer, AnotherSeedGivesAnotherNoiseAroundTheSamePicture) {
  const Image a = render(small(16, 1)), b = render(small(16, 2));
  size_t different = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) different += a.pixels[i] != b.pixels[i] ? 1 : 0;
  EXPECT_GT(different, a.pixels.size() / 2);
  const test::Estimate first = test::estimate(a), second = test::estimate(b);
  EXPECT_NEAR(first.mean.x, second.mean.x, 0.02 * first.mean.x);
}

TEST(PathTracer, EveryStructureGivesThePictureOfBruteForce) {
  const Image brute = render(small(4, 5), "brute_force");
  int compared = 0;
  for (const std::string& structure : test::all_pipelines()) {
    EXPECT_EQ(brute.pixels, render(small(4, 5), structure).pixels) << structure;
    ++compared;
  }
  EXPECT_GE(compared, 8);
}

TEST(PathTracer, MoreSamplesAreNearerToTheTruth) {
  const Image truth = render(small(1024, 9));
  const auto error = [&](const Image& image) {
    double sum = 0;
    for (size_t i = 0; i < image.pixels.size(); ++i) sum += std::pow(double{image.pixels[i]} - truth.pixels[i], 2);
    return sum;
  };
  const double few = error(render(small(4, 1))), more = error(render(small(16, 1))), most = error(render(small(64, 1)));
  EXPECT_LT(more, few / 3);
  EXPECT_LT(most, more / 3);
}

TEST(PathTracer, AnInterruptLeavesAWholePicture) {
  const RenderScene scene(mixed_scene());
  PathTracerOptions options = small(64, 1);
  options.progress = [](double done) { return done < 0.3; };
  const PathTracerResult result = render_paths(scene, kCamera, options);
  EXPECT_FALSE(result.complete);
  EXPECT_LT(result.paths, 50U * 37 * 64);
  EXPECT_GE(result.paths, 50U * 37 * 16);
  const Image whole = render(small(256, 2));
  const test::Estimate seen = test::estimate(result.radiance), expected = test::estimate(whole);
  EXPECT_NEAR(seen.mean.y, expected.mean.y, 0.05 * expected.mean.y);
  for (size_t i = 0; i < result.radiance.pixels.size(); ++i) ASSERT_GT(result.radiance.pixels[i], 0) << i;
}

TEST(PathTracer, ProgressGrowsToOne) {
  const RenderScene scene(mixed_scene());
  PathTracerOptions options = small(6, 1);
  double last = 0;
  options.progress = [&](double done) {
    EXPECT_GT(done, last);
    last = done;
    return true;
  };
  const PathTracerResult result = render_paths(scene, kCamera, options);
  EXPECT_DOUBLE_EQ(last, 1);
  EXPECT_EQ(result.paths, 50U * 37 * 6);
  EXPECT_GT(result.rays, result.paths);
}

TEST(PathTracer, OnePixelAndOneSample) {
  PathTracerOptions options;
  options.width = options.height = options.samples = 1;
  EXPECT_EQ(render(options).pixels.size(), 3U);
}

TEST(RenderScene, RefusesNumbersOutOfRange) {
  const auto expect_refused = [](auto&& damage) {
    SceneDescription scene = mixed_scene();
    damage(scene);
    EXPECT_THROW(RenderScene{std::move(scene)}, Error);
  };
  const auto mesh = [](SceneDescription& scene) -> Mesh& { return std::get<Mesh>(scene.objects.back().shape); };
  expect_refused([](SceneDescription& s) { s.objects[2].material = 99; });
  expect_refused([](SceneDescription& s) { s.materials[1].albedo_texture = 0; });
  expect_refused([&](SceneDescription& s) { mesh(s).materials = {0}; });
  expect_refused([&](SceneDescription& s) { mesh(s).materials = {0, 77}; });
  expect_refused([&](SceneDescription& s) { mesh(s).normals.pop_back(); });
  expect_refused([&](SceneDescription& s) { mesh(s).normal_corners = {{0, 1, 2}, {0, 1, 4}}; });
  expect_refused([&](SceneDescription& s) { mesh(s).uvs = {{0, 0}}; });
  expect_refused([&](SceneDescription& s) { mesh(s).triangles[0][0] = 9; });
  SceneDescription scene = mixed_scene();
  std::get<Mesh>(scene.objects.back().shape).normal_corners = {{0, 1, 2}, {kNone, kNone, kNone}};
  EXPECT_NO_THROW(RenderScene{std::move(scene)}) << "a corner without a normal is flat";
}

TEST(RenderScene, NamesTheObjectThatIsInvalid) {
  SceneDescription scene = mixed_scene();
  scene.objects.back().place = "room.yaml:12:5";
  std::get<Mesh>(scene.objects.back().shape).vertices[2].y = std::nanf("");
  try {
    RenderScene built(std::move(scene));
    ADD_FAILURE() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::invalid_geometry);
    EXPECT_EQ(error.place(), "room.yaml:12:5");
  }
}

}  // namespace
}  // namespace kerf
