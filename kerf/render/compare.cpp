#include "kerf/render/compare.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "kerf/render/picture_rays.h"

namespace kerf {
namespace {

constexpr double kPixels = 3e4;
constexpr int kRuns = 5;

/// Of a picture of kPixels.
std::vector<Ray> rays_of_picture(const Scene& scene, const Camera& camera, double aspect) {
  const auto width = static_cast<uint32_t>(std::max(1.0, std::sqrt(kPixels * aspect)));
  const auto height = static_cast<uint32_t>(std::max(1.0, std::sqrt(kPixels / aspect)));
  return picture_rays(scene, camera, width, height).rays;
}

double seconds_of(const Scene& scene, std::span<const Ray> rays, std::span<Hit> hits) {
  const auto start = std::chrono::steady_clock::now();
  scene.closest_hit(rays, hits, 1);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

std::vector<StructureCost> compare_structures(const SceneDescription& description, const Camera& camera, double aspect,
                                              std::span<const BuildOptions> structures) {
  std::vector<Scene> scenes;
  for (const BuildOptions& options : structures) scenes.push_back(build_scene(description, options));
  if (scenes.empty()) return {};
  const std::vector<Ray> rays = rays_of_picture(scenes.front(), camera, aspect);
  std::vector<StructureCost> costs;
  for (const Scene& scene : scenes) {
    TraceCounts counts;
    for (const Ray& ray : rays) scene.closest_hit(ray, counts);
    const auto per_ray = [&](uint64_t count) { return static_cast<double>(count) / static_cast<double>(rays.size()); };
    const BuildReport& report = scene.report();
    costs.push_back({report.structure, report.references_per_primitive, per_ray(counts.nodes),
                     per_ray(counts.primitives), 0, rays.size()});
  }
  std::vector<Hit> hits(rays.size());
  std::vector<std::vector<double>> seconds(scenes.size());
  for (int run = 0; run < kRuns; ++run) {
    for (size_t i = 0; i < scenes.size(); ++i) seconds[i].push_back(seconds_of(scenes[i], rays, hits));
  }
  for (size_t i = 0; i < scenes.size(); ++i) {
    std::nth_element(seconds[i].begin(), seconds[i].begin() + kRuns / 2, seconds[i].end());
    costs[i].seconds = seconds[i][kRuns / 2];
  }
  return costs;
}

}  // namespace kerf
