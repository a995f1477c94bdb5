#pragma once

#include <cstdint>
#include <functional>

#include "kerf/io/image.h"
#include "kerf/render/camera.h"
#include "kerf/render/render_scene.h"

namespace kerf {

struct PathTracerOptions {
  uint32_t width = 960, height = 640;
  uint32_t samples = 64;  ///< paths of each pixel
  uint32_t seed = 0;
  int threads = 0;
  /// Called now and then from one thread at a time with the share that is done; returns false to stop.
  std::function<bool(double)> progress;
};

struct PathTracerResult {
  Image radiance;                ///< linear RGB, the mean of each pixel's paths
  bool complete = true;          ///< false if progress() stopped it: pixels are means of fewer paths, black without any
  uint64_t paths = 0, rays = 0;  ///< rays: of all kinds
  uint64_t invalid = 0;          ///< paths whose radiance was not a finite number, left out of the means
  double seconds = 0;
};

/// Renders by unidirectional path tracing (Kajiya 1986) with next-event estimation, multiple importance sampling (Veach
/// 1997) and Russian roulette: unbiased. Light that reaches a lambertian surface through smooth glass or mirrors is
/// found by chance only, so it is noisy.
///
/// Works on tiles: generates a queue of paths, traces all of it, shades all of it, until none is left. The picture is
/// the same, bit for bit, for any number of threads and any structure; without an interrupt it depends on the scene,
/// the camera, the size, the samples and the seed.
PathTracerResult render_paths(const RenderScene& scene, const Camera& camera, const PathTracerOptions& options);

/// A linear picture as a display shows it: brightened by a number of stops, sRGB encoded, clamped to [0, 1].
Image srgb_picture(Image picture, float stops = 0);

}  // namespace kerf
