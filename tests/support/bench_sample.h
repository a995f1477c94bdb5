#pragma once

#include <string>
#include <vector>

#include "kerf/study/bench_result.h"

namespace kerf::test {

inline const std::vector<std::string> kBenchKinds = {"primary", "diffuse", "shadow"};

/// Adds a finished row: seconds of three runs over each kind of rays, fed that way, and of a build. A hundred bytes for
/// each of 1200 references.
inline BenchRow& add_bench_row(BenchScene& scene, BenchEngine engine, const std::string& quality, double seconds,
                               double build) {
  BenchRow row;
  row.engine = engine;
  row.quality = quality;
  row.layout = engine == BenchEngine::kerf ? "bvh8" : "BVH8<triangle4>";
  row.isa = "avx2";
  row.builder = quality + "_builder";
  row.finished = true;
  row.why_not.clear();
  row.references = 1200;
  row.bytes = 120000;
  row.builds = {build, build * 2, build / 2};
  for (size_t kind = 0; kind < kBenchKinds.size(); ++kind) {
    row.runs.push_back({kind, Feed::loop, 500, 0, {}, {seconds, seconds, seconds}});
    if (engine == BenchEngine::kerf) row.runs.back().unlike_kerf = 0;
  }
  scene.rows.push_back(std::move(row));
  return scene.rows.back();
}

/// Rays of a row that are fed another way.
inline void add_bench_feed(BenchRow& row, Feed feed, double seconds) {
  for (size_t kind = 0; kind < kBenchKinds.size(); ++kind) {
    row.runs.push_back({kind, feed, 500, 0, {}, {seconds, seconds, seconds}});
    if (row.engine == BenchEngine::kerf) row.runs.back().unlike_kerf = 0;
  }
}

/// A scene on which every goal is reached that one scene and one thread can show. Embree HIGH: a second for the rays of
/// each kind, a second to build.
inline BenchScene made_bench_scene(const std::string& name = "sanmiguel") {
  BenchScene scene;
  scene.name = name;
  scene.turn = "straight";
  scene.triangles = 1000;
  scene.kinds = kBenchKinds;
  scene.ray_counts.assign(kBenchKinds.size(), 1000000);
  scene.rival = "Embree 3";
  scene.rows.reserve(16);
  BenchRow& best = add_bench_row(scene, BenchEngine::kerf, "best", 0.7, 0.9);
  add_bench_feed(best, Feed::batch, 0.5);
  add_bench_row(scene, BenchEngine::kerf, "balanced", 1.0, 0.35);
  add_bench_row(scene, BenchEngine::kerf, "fast", 2.0, 0.15);
  BenchRow& small = add_bench_row(scene, BenchEngine::kerf, "best", 0.75, 0.9);
  small.layout = "quantised_bvh8";
  small.bytes = 50000;
  BenchRow& high = add_bench_row(scene, BenchEngine::embree, "high", 1.0, 1.0);
  add_bench_feed(high, Feed::sorted, 0.8);
  add_bench_feed(high, Feed::stream, 0.7);
  add_bench_row(scene, BenchEngine::embree, "medium", 1.3, 0.2);
  add_bench_row(scene, BenchEngine::embree, "robust", 1.5, 0.2);
  for (size_t kind = 0; kind < kBenchKinds.size(); ++kind) {
    scene.verdicts.emplace_back();
    scene.verdicts.back().counts = {999990, 4, 3, 3, 0};
  }
  return scene;
}

/// The row of that engine and quality, the first of them.
inline BenchRow& bench_row_of(BenchScene& scene, BenchEngine engine, const std::string& quality) {
  for (BenchRow& row : scene.rows) {
    if (row.engine == engine && row.quality == quality) return row;
  }
  scene.rows.emplace_back();
  return scene.rows.back();
}

}  // namespace kerf::test
