// kerf_bench_tracing: rays through each layout by each instruction set that the machine has, one at a time and in
// batches, on one thread, over a model out of a program; and the parts of a traversal by themselves: rays that meet a
// node's eight boxes and enter none, and rays that meet one leaf of so many triangles.
//
// Example: kerf_bench_tracing --benchmark_filter=bvh8/avx2 --benchmark_repetitions=9

#include <benchmark/benchmark.h>

#include <cstdlib>
#include <memory>
#include <string>

#include "bench/benchmark_main.h"
#include "kerf/base/instruction_set.h"
#include "kerf/render/picture_rays.h"
#include "kerf/scene/scene.h"
#include "kerf/study/models/models.h"

namespace kerf {
namespace {

constexpr uint64_t kTriangles = 100000, kSeed = 1;
constexpr uint32_t kWidth = 200, kHeight = 150;

/// A mesh and the rays that are shot at it.
struct Work {
  Mesh mesh;
  std::vector<Ray> rays;
};
using SharedWork = std::shared_ptr<const Work>;

std::unique_ptr<Scene> scene_of(const Mesh& mesh, const std::string& structure) {
  auto scene = std::make_unique<Scene>();
  scene->add(TriangleMesh{mesh.vertices, mesh.triangles});
  scene->build({.structure = structure, .threads = 1});
  return scene;
}

/// Primary rays, then diffuse ones.
SharedWork model_work() {
  MadeModel model = make_model("city", kTriangles, kSeed);
  std::vector<Ray> rays = picture_rays(*scene_of(model.mesh, "fast"), model.camera, kWidth, kHeight).rays;
  return std::make_shared<Work>(Work{std::move(model.mesh), std::move(rays)});
}

/// Triangles side by side along x with gaps, each from (i, 0, 0) to (i + 0.5, 1, 0), and rays along z at height `y`.
SharedWork row_work(uint32_t triangles, float y) {
  Work work;
  for (uint32_t i = 0; i < triangles; ++i) {
    const auto x = static_cast<float>(i);
    work.mesh.vertices.insert(work.mesh.vertices.end(), {{x, 0, 0}, {x + 0.5F, 0, 0}, {x, 1, 0}});
    work.mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  constexpr uint32_t kRays = 1000;
  for (uint32_t i = 0; i < kRays; ++i) {
    const float x = static_cast<float>(triangles) * static_cast<float>(i) / kRays;
    work.rays.push_back({.origin = {x, y, -1}, .direction = {0, 0, 1}});
  }
  return std::make_shared<Work>(std::move(work));
}

enum class Query { closest, any, batch };

void run(benchmark::State& state, const Work& work, const std::string& structure, const std::string& set, Query query) {
  setenv("KERF_ISA", set.c_str(), 1);  // NOLINT(concurrency-mt-unsafe): one thread
  const auto scene = scene_of(work.mesh, structure);
  std::vector<Hit> hits(work.rays.size());
  for (auto _ : state) {
    if (query == Query::batch) {
      scene->closest_hit(work.rays, hits, 1);  // figures are of the time of this thread
    } else if (query == Query::any) {
      for (const Ray& ray : work.rays) benchmark::DoNotOptimize(scene->any_hit(ray));
    } else {
      for (const Ray& ray : work.rays) benchmark::DoNotOptimize(scene->closest_hit(ray));
    }
    benchmark::DoNotOptimize(hits.data());
  }
  const double all = static_cast<double>(work.rays.size()) * static_cast<double>(state.iterations());
  state.counters["per_ray"] = benchmark::Counter(all, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void add(const std::string& name, const SharedWork& work, const std::string& structure, std::string_view set,
         Query query = Query::closest) {
  const std::string instructions(set);
  const std::string full_name = set.empty() ? name : name + "/" + instructions;
  benchmark::RegisterBenchmark(full_name.c_str(), [=](benchmark::State& state) {
    run(state, *work, structure, instructions, query);
  })->Unit(benchmark::kMillisecond);
}

void add_all() {
  constexpr uint32_t kMostInLeaf = 8;
  const SharedWork model = model_work();
  const SharedWork past = row_work(kMostInLeaf, -0.25F), leaf = row_work(kMostInLeaf, 0.25F), one = row_work(1, 0.25F);
  for (const std::string_view set : instruction_sets()) {
    for (const std::string layout : {"bvh4", "bvh8", "quantised_bvh8"}) {
      const std::string best = "best+" + layout;
      add("closest_hit/" + layout, model, best, set);
      add("any_hit/" + layout, model, best, set, Query::any);
      add("batch/" + layout, model, best, set, Query::batch);
      // Leaves for nothing make each triangle a child of the root; leaves that cost all make all one leaf.
      const std::string apart = "binned_sah(leaf=1)+" + layout + "(leaf_cost=0,triangle_cost=1)";
      const std::string together = "binned_sah(leaf=1)+" + layout + "(leaf_cost=1e6,triangle_cost=0)";
      add("node_of_eight/" + layout, past, apart, set);
      add("leaf_of_eight/" + layout, leaf, together, set);
      add("leaf_of_one/" + layout, one, together, set);
    }
  }
  for (const std::string layout : {"bvh2", "packets"}) {
    add("closest_hit/" + layout, model, "best+" + layout, "");
    add("batch/" + layout, model, "best+" + layout, "", Query::batch);
  }
}

}  // namespace
}  // namespace kerf

int main(int argc, char** argv) { return kerf::run_benchmarks(argc, argv, kerf::add_all); }
