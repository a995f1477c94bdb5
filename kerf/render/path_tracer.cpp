#include "kerf/render/path_tracer.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>
#include <vector>

#include "kerf/base/parallel.h"
#include "kerf/render/bsdf.h"
#include "kerf/render/color.h"
#include "kerf/render/lights.h"
#include "kerf/render/sampler.h"

namespace kerf {
namespace {

constexpr uint32_t kTileSide = 16;    // pixels; with 8 samples each that is 2048 paths, some 300 KB of queues
constexpr uint32_t kMostSamples = 8;  // of each pixel in one queue
constexpr uint32_t kSureBounces = 4;  // before Russian roulette begins
constexpr float kMostSurvival = 0.95F;

/// A path on its way from the camera, between two bounces.
struct Path {
  Vec3f throughput{1, 1, 1};
  float density = 0;  // of the ray's direction; 0 where it was the only one
  float scale = 1;    // of the throughput by dielectrics, undone: what Russian roulette is to judge
  uint32_t slot = 0;  // of its radiance
  uint32_t bounces = 0;
  Sampler sampler;
};

/// What a point gets from a light if nothing is in between.
struct Connection {
  Vec3f radiance;
  uint32_t slot;
};

/// The share of a strategy with density a among two (Veach 1997, the power heuristic with exponent 2).
float power_heuristic(float a, float b) {
  if (!(b > 0)) return 1;
  const float ratio = b / a;
  return 1 / (1 + ratio * ratio);
}

struct Counts {
  uint64_t paths = 0, rays = 0, invalid = 0;
};

/// The sums of all pixels.
struct Film {
  std::vector<Vec3d> sums;
  std::vector<uint32_t> samples;
};

/// The pixels [x0, x1) x [y0, y1).
struct Tile {
  uint32_t x0, y0, x1, y1;
};

/// Renders tiles, one at a time, in queues that it keeps.
class TileTracer {
 public:
  TileTracer(const RenderScene& scene, const Lights& lights, const CameraRays& camera, const PathTracerOptions& options)
      : scene_(scene), lights_(lights), camera_(camera), options_(options) {}

  /// Adds `count` paths of each of the tile's pixels, from number `first` on, to the film.
  void render(const Tile& tile, uint32_t first, uint32_t count, Film& film) {
    generate(tile, first, count);
    while (!paths_.empty()) {
      hits_.resize(rays_.size());
      scene_.scene().closest_hit(rays_, hits_, 1);
      counts.rays += rays_.size();
      shade();
      connect();
    }
    add_to_film(tile, count, film);
  }

  Counts counts;

 private:
  void generate(const Tile& tile, uint32_t first, uint32_t count) {
    paths_.clear();
    rays_.clear();
    for (uint32_t y = tile.y0; y < tile.y1; ++y) {
      for (uint32_t x = tile.x0; x < tile.x1; ++x) {
        for (uint32_t sample = first; sample < first + count; ++sample) {
          Path path;
          path.slot = static_cast<uint32_t>(paths_.size());
          path.sampler = Sampler(options_.seed, y * options_.width + x, sample);
          const auto [dx, dy] = path.sampler.next_pair();
          rays_.push_back(camera_(x + double{dx}, y + double{dy}));
          paths_.push_back(path);
        }
      }
    }
    radiance_.assign(paths_.size(), {});
    counts.paths += paths_.size();
  }

  /// One bounce of all paths; those that go on stay in the queues.
  void shade() {
    shadow_rays_.clear();
    connections_.clear();
    size_t kept = 0;
    for (size_t i = 0; i < paths_.size(); ++i) {
      Path path = paths_[i];
      Ray ray = rays_[i];
      if (!bounce(path, ray, hits_[i])) continue;
      paths_[kept] = path;
      rays_[kept] = ray;
      ++kept;
    }
    paths_.resize(kept);
    rays_.resize(kept);
  }

  /// Adds what the ray meets to the path's radiance and makes the ray that goes on; false where the path ends.
  bool bounce(Path& path, Ray& ray, const Hit& hit) {
    if (!hit) {
      add(path, scene_.background(path.bounces == 0));
      return false;
    }
    const Surface surface = scene_.surface(ray, hit);
    const Vec3f to_eye = -normalized(ray.direction);
    add_emission(path, ray, hit, surface);
    const Bsdf bsdf(surface, to_eye);
    if (!bsdf.scatters()) return false;
    const Vec3f eye_side =
        dot(surface.geometric_normal, to_eye) < 0 ? -surface.geometric_normal : surface.geometric_normal;
    if (bsdf.is_smooth()) sample_light(path, surface.point, offset_origin(surface.point, eye_side), bsdf);

    const float lobe = path.sampler.next();
    BsdfSample sample;
    if (!bsdf.sample(lobe, path.sampler.next_pair(), sample)) return false;
    path.throughput = scaled(path.throughput, sample.weight);
    path.density = sample.density;
    path.scale /= sample.scale;
    ++path.bounces;
    ray = {};
    ray.origin = offset_origin(surface.point, sample.direction);
    ray.direction = sample.direction;
    ray.mask = kIndirectMask;
    return survives(path);
  }

  static bool survives(Path& path) {
    const float largest_part = largest(path.throughput) * path.scale;
    if (!(largest_part > 0)) return false;
    if (path.bounces < kSureBounces) return true;
    const float chance = std::min(largest_part, kMostSurvival);
    if (path.sampler.next() >= chance) return false;
    path.throughput = path.throughput / chance;
    return true;
  }

  void add(const Path& path, Vec3f radiance) {
    Vec3f& sum = radiance_[path.slot];
    sum = sum + scaled(path.throughput, radiance);
  }

  void add_emission(const Path& path, const Ray& ray, const Hit& hit, const Surface& surface) {
    const Material& material = *surface.material;
    if (material.type == MaterialType::constant) add(path, surface.albedo);
    if (material.type == MaterialType::show_normals) {
      add(path, surface.shading_normal * 0.5F + Vec3f{0.5F, 0.5F, 0.5F});
    }
    if (material.emission == Vec3f{}) return;
    float weight = 1;
    if (path.density > 0) {
      const Vec3d from = to_double(ray.origin), way = surface.point.position - from;
      const float by_light =
          lights_.density(from, ray.direction, std::sqrt(dot(way, way)), surface.point, hit.geometry, hit.primitive);
      weight = power_heuristic(path.density, by_light);
    }
    add(path, material.emission * weight);
  }

  /// Next-event estimation: a point of a light, and the ray that asks whether it is seen.
  void sample_light(Path& path, const SurfacePoint& receiver, Vec3f origin, const Bsdf& bsdf) {
    const float choice = path.sampler.next();
    const auto u = path.sampler.next_pair();
    LightSample light;
    if (!lights_.sample(to_double(origin), choice, u, light)) return;
    const Vec3f scattered = bsdf.evaluate(light.direction);
    if (scattered == Vec3f{}) return;
    const float weight = power_heuristic(light.density, bsdf.density(light.direction)) / light.density;
    // The far end is moved to this side of the light, by as much as the rounding of the ray's direction can be too.
    light.point.extent = std::max(light.point.extent, 0x1p26 * largest(abs(receiver.position)));
    Ray shadow;
    shadow.origin = origin;
    shadow.direction = offset_origin(light.point, -light.direction) - origin;
    // By a power of two, which is exact, for a ray's direction may be neither very long nor very short.
    const int exponent = std::ilogb(largest(abs(shadow.direction)));
    shadow.direction = shadow.direction * std::ldexp(1.0F, -exponent);
    shadow.t_max = std::ldexp(1 - 0x1p-22F, exponent);
    shadow.mask = kIndirectMask;
    shadow_rays_.push_back(shadow);
    connections_.push_back({scaled(scaled(path.throughput, scattered), light.radiance) * weight, path.slot});
  }

  void connect() {
    hidden_.resize(shadow_rays_.size());
    scene_.scene().any_hit(shadow_rays_, hidden_, 1);
    counts.rays += shadow_rays_.size();
    for (size_t i = 0; i < connections_.size(); ++i) {
      if (hidden_[i] != 0) continue;
      Vec3f& sum = radiance_[connections_[i].slot];
      sum = sum + connections_[i].radiance;
    }
  }

  void add_to_film(const Tile& tile, uint32_t count, Film& film) {
    size_t slot = 0;
    for (uint32_t y = tile.y0; y < tile.y1; ++y) {
      for (uint32_t x = tile.x0; x < tile.x1; ++x) {
        const size_t pixel = size_t{y} * options_.width + x;
        for (uint32_t i = 0; i < count; ++i) {
          const Vec3f radiance = radiance_[slot++];
          if (!is_finite(radiance)) {
            ++counts.invalid;
            continue;
          }
          film.sums[pixel] = film.sums[pixel] + to_double(radiance);
          ++film.samples[pixel];
        }
      }
    }
  }

  const RenderScene& scene_;
  const Lights& lights_;
  const CameraRays& camera_;
  const PathTracerOptions& options_;
  std::vector<Path> paths_;
  std::vector<Ray> rays_, shadow_rays_;
  std::vector<Hit> hits_;
  std::vector<Connection> connections_;
  std::vector<uint8_t> hidden_;
  std::vector<Vec3f> radiance_;
};

std::vector<Tile> tiles_of(uint32_t width, uint32_t height) {
  std::vector<Tile> tiles;
  for (uint32_t y = 0; y < height; y += kTileSide) {
    for (uint32_t x = 0; x < width; x += kTileSide) {
      tiles.push_back({x, y, std::min(x + kTileSide, width), std::min(y + kTileSide, height)});
    }
  }
  return tiles;
}

void write_means(const Film& film, Image& image) {
  for (size_t i = 0; i < film.sums.size(); ++i) {
    const Vec3d mean = film.sums[i] / static_cast<double>(std::max(1U, film.samples[i]));
    for (uint32_t c = 0; c < 3; ++c) image.pixels[3 * i + c] = static_cast<float>(mean[c]);
  }
}

}  // namespace

Image srgb_picture(Image picture, float stops) {
  const float factor = std::exp2(stops);
  for (float& value : picture.pixels) value = srgb_encoded(value * factor);
  return picture;
}

PathTracerResult render_paths(const RenderScene& scene, const Camera& camera, const PathTracerOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const CameraRays rays(camera, options.width, options.height);
  const Lights lights(scene);
  const std::vector<Tile> tiles = tiles_of(options.width, options.height);
  Film film;
  film.sums.resize(size_t{options.width} * options.height);
  film.samples.resize(film.sums.size());
  PathTracerResult result;
  result.radiance = {options.width, options.height, 3, {}};
  result.radiance.pixels.resize(film.sums.size() * 3);  // now: if memory does not do, that is better known at once
  std::mutex mutex;                                     // of the sums in `result`, `work` and progress()
  std::atomic<bool> stop = false;
  double work = 0;  // pixels times samples
  const double all_work = static_cast<double>(film.sums.size()) * options.samples;
  // All tiles get their first samples before any gets many: an interrupt leaves a whole picture.
  uint32_t samples = 0;
  while (samples < options.samples && !stop) {
    const uint32_t count = std::min({std::max(samples, 1U), kMostSamples, options.samples - samples});
    const auto render_tiles = [&](size_t begin, size_t end) {
      TileTracer tracer(scene, lights, rays, options);
      for (size_t i = begin; i < end && !stop.load(std::memory_order_relaxed); ++i) {
        const Tile& tile = tiles[i];
        tracer.counts = {};
        tracer.render(tile, samples, count, film);
        const std::lock_guard lock(mutex);
        result.paths += tracer.counts.paths;
        result.rays += tracer.counts.rays;
        result.invalid += tracer.counts.invalid;
        work += static_cast<double>(tracer.counts.paths);
        if (options.progress && !stop && !options.progress(work / all_work)) stop = true;
      }
    };
    with_threads(options.threads, [&] { parallel_for(tiles.size(), 1, render_tiles); });
    samples += count;
  }
  write_means(film, result.radiance);
  result.complete = work == all_work;
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace kerf
