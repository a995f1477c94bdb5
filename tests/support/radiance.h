// Mean radiances with their standard errors, to be compared with closed forms.

#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "kerf/render/path_tracer.h"

namespace kerf::test {

/// A mean over pixels that all see the same, and its standard error. Pixels are independent of each other; the samples
/// of one are not, for they are spread evenly.
struct Estimate {
  Vec3d mean, error;
};

inline Estimate estimate(const Image& image) {
  const size_t count = image.pixels.size() / 3;
  Vec3d sum, squares;
  for (size_t i = 0; i < count; ++i) {
    const Vec3d p{image.pixels[3 * i], image.pixels[3 * i + 1], image.pixels[3 * i + 2]};
    sum = sum + p;
  }
  const Vec3d mean = sum / static_cast<double>(count);
  for (size_t i = 0; i < count; ++i) {
    for (uint32_t c = 0; c < 3; ++c) squares[c] += std::pow(double{image.pixels[3 * i + c]} - mean[c], 2);
  }
  Estimate result{mean, {}};
  for (uint32_t c = 0; c < 3; ++c) {
    result.error[c] = std::sqrt(squares[c] / static_cast<double>(count * (count - 1)));
  }
  return result;
}

/// Renders 32 x 32 pixels of which all see the same.
inline Estimate mean_radiance(SceneDescription scene, const Camera& camera, uint32_t samples = 64, uint32_t seed = 1) {
  const RenderScene built(std::move(scene));
  PathTracerOptions options;
  options.width = options.height = 32;
  options.samples = samples;
  options.seed = seed;
  const PathTracerResult result = render_paths(built, camera, options);
  EXPECT_EQ(result.invalid, 0U);
  return estimate(result.radiance);
}

/// Within three standard errors, which themselves must be small enough to tell anything; rounding to float comes on
/// top.
inline void expect_radiance(const Estimate& estimate, Vec3d expected, double largest_error = 0.01) {
  for (uint32_t c = 0; c < 3; ++c) {
    const double scale = std::max(std::abs(expected[c]), 1e-12);
    EXPECT_LE(estimate.error[c], largest_error * scale) << "too noisy to tell; channel " << c;
    EXPECT_NEAR(estimate.mean[c], expected[c], 3 * estimate.error[c] + 2e-6 * scale)
        << "channel " << c << ": " << (estimate.mean[c] - expected[c]) / estimate.error[c] << " standard errors off";
  }
}

inline Material make_material(MaterialType type, Vec3f albedo = {1, 1, 1}) {
  Material material;
  material.type = type;
  material.albedo = albedo;
  return material;
}

inline Material make_light(Vec3f emission) {
  Material material;
  material.type = MaterialType::light;
  material.emission = emission;
  return material;
}

/// A scene with nothing but a background.
inline SceneDescription empty_scene(Vec3f background) {
  SceneDescription scene;
  scene.background = {background, 1, 0};
  return scene;
}

/// Adds an object of a new material.
template <class Shape>
void add(SceneDescription& scene, Shape shape, const Material& material, bool visible = true) {
  scene.materials.push_back(material);
  SceneObject object;
  object.shape = std::move(shape);
  object.material = static_cast<uint32_t>(scene.materials.size() - 1);
  object.visible = visible;
  scene.objects.push_back(std::move(object));
}

/// A camera that looks at one point, through all of its pixels.
inline Camera spot(Vec3d eye, Vec3d at, Vec3d up = {0, 1, 0}) { return {eye, at, up, 1e-3}; }

}  // namespace kerf::test
