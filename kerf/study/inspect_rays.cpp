#include "kerf/study/inspect_rays.h"

#include <algorithm>
#include <chrono>
#include <mutex>

#include "kerf/base/parallel.h"

namespace kerf {
namespace {

constexpr int kRuns = 3;
constexpr size_t kLeastStretch = 4096;  // rays that are worth a tally of their own
constexpr size_t kMostStretches = 8;    // of which each has one

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
