#include "kerf/study/inspect_rays.h"

#include <algorithm>
#include <chrono>
#include <mutex>

#include "kerf/base/parallel.h"
#include "kerf/render/camera.h"
#include "kerf/render/frame.h"
#include "kerf/render/sampler.h"
#include "kerf/render/surface.h"

namespace kerf {
namespace {

constexpr int kRuns = 3;
constexpr size_t kLeastStretch = 4096;  // rays that are worth a tally of their own
constexpr size_t kMostStretches = 8;    // of which each has one

/// Where a ray hit something, from the shape itself: t alone is not exact enough to start another ray from.
SurfacePoint point_of(const Geometry& geometry, const Ray& ray, const Hit& hit) {
  if (const auto* mesh = std::get_if<TriangleMesh>(&geometry.shapes)) {
    return triangle_point(mesh->triangle(hit.primitive), hit.u, hit.v);
  }
  if (const auto* shapes = std::get_if<Strided<Parallelogram>>(&geometry.shapes)) {
    return parallelogram_point((*shapes)[hit.primitive], hit.u, hit.v);
  }
  const Sphere sphere = (*std::get_if<Strided<Sphere>>(&geometry.shapes))[hit.primitive];
  return sphere_point(sphere,
                      to_double(ray.origin) - to_double(sphere.center) + to_double(ray.direction) * double{hit.t});
}

/// From a hit to the side that the ray came from.
Ray diffuse_ray(const Scene& scene, const Ray& from, const Hit& hit, uint32_t pixel) {
  const SurfacePoint point = point_of(scene.geometries()[hit.geometry], from, hit);
  Vec3f normal = to_float(point.normal);
  if (dot(normal, from.direction) > 0) normal = -normal;
  Sampler sampler(1, pixel, 0);
  Ray ray;
  ray.direction = Frame(normal).to_world(cosine_direction(sampler.next_pair()));
  ray.origin = offset_origin(point, ray.direction);
  ray.mask = kIndirectMask;
  return ray;
}

PrimitiveTally zeros(const Scene& scene) {
  PrimitiveTally tally;
  for (const Geometry& geometry : scene.geometries()) tally.emplace_back(primitive_count(geometry));
  return tally;
}

void add_to(RayTally& sum, const TraceCounts& more) {
  sum.counts.nodes += more.nodes;
  sum.counts.primitives += more.primitives;
  sum.counts.boxes += more.boxes;
  for (size_t g = 0; g < sum.tests.size(); ++g) {
    for (size_t p = 0; p < sum.tests[g].size(); ++p) sum.tests[g][p] += (*more.tests)[g][p];
  }
}

}  // namespace

PictureRays picture_rays(const Scene& scene, const Camera& camera, uint32_t width, uint32_t height) {
  const CameraRays pixel(camera, width, height);
  PictureRays picture;
  picture.primary = size_t{width} * height;
  picture.rays.resize(picture.primary);
  std::vector<Hit> hits(picture.primary);
  for (size_t i = 0; i < picture.primary; ++i) {
    picture.rays[i] = pixel.center(static_cast<uint32_t>(i % width), static_cast<uint32_t>(i / width));
  }
  scene.closest_hit(picture.rays, hits);
  for (size_t i = 0; i < picture.primary; ++i) {
    if (!hits[i]) continue;
    picture.rays.push_back(diffuse_ray(scene, Ray(picture.rays[i]), hits[i], static_cast<uint32_t>(i)));
  }
  return picture;
}

RayTally tally_rays(const Scene& scene, std::span<const Ray> rays) {
  const size_t stretches =
      std::clamp<size_t>(rays.size() / kLeastStretch, 1, std::min(kMostStretches, static_cast<size_t>(thread_count())));
  const size_t stretch = (rays.size() + stretches - 1) / stretches;
  RayTally sum;
  sum.tests = sum.hits = zeros(scene);
  std::vector<Hit> hits(rays.size());
  std::mutex mutex;  // of `sum`, whose figures are whole: any order gives the same
  parallel_for(rays.size(), stretch, [&](size_t begin, size_t end) {
    PrimitiveTally tests = zeros(scene);
    TraceCounts counts;
    counts.tests = &tests;
    scene.closest_hit(rays.subspan(begin, end - begin), std::span(hits).subspan(begin, end - begin), counts);
    const std::lock_guard lock(mutex);
    add_to(sum, counts);
  });
  for (const Hit& hit : hits) {
    if (!hit) continue;
    ++sum.hit_count;
    ++sum.hits[hit.geometry][hit.primitive];
  }
  return sum;
}

std::vector<double> time_rays(std::span<const Scene* const> scenes, std::span<const Ray> rays) {
  using Clock = std::chrono::steady_clock;
  std::vector<Hit> hits(rays.size());
  std::vector<std::vector<double>> seconds(scenes.size());
  for (int run = 0; run < kRuns; ++run) {
    for (size_t i = 0; i < scenes.size(); ++i) {
      const auto start = Clock::now();
      scenes[i]->closest_hit(rays, hits, 1);
      seconds[i].push_back(std::chrono::duration<double>(Clock::now() - start).count());
    }
  }
  std::vector<double> medians;
  for (std::vector<double>& runs : seconds) {
    std::nth_element(runs.begin(), runs.begin() + kRuns / 2, runs.end());
    medians.push_back(runs[kRuns / 2]);
  }
  return medians;
}

}  // namespace kerf
