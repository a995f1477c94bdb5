// kerf_bench_building: what each stage of a build takes, on one thread and on two, over a model out of a program.
//
// Example: kerf_bench_building --benchmark_filter=binned_sah --benchmark_repetitions=9

#include <benchmark/benchmark.h>

#include <memory>
#include <string>

#include "bench/benchmark_main.h"
#include "kerf/base/parallel.h"
#include "kerf/build/builders.h"
#include "kerf/build/optimisers.h"
#include "kerf/choose/automatic_split.h"
#include "kerf/layout/wide_bvh.h"
#include "kerf/layout/wide_collapse.h"
#include "kerf/study/models/models.h"

namespace kerf {
namespace {

constexpr uint64_t kTriangles = 100000, kSeed = 1;

/// What stages work on.
struct Work {
  MadeModel model = make_model("city", kTriangles, kSeed);
  Geometry geometry{TriangleMesh{model.mesh.vertices, model.mesh.triangles}};
  std::span<const Geometry> geometries{&geometry, 1};
  Clipper clipper = geometry_clipper(geometries);
  std::vector<Reference> references = make_references(geometries).references;
  Bvh bvh = build("binned_sah", references);

  Bvh build(std::string_view name, std::vector<Reference> from) const {
    for (const BuilderEntry& builder : builders()) {
      if (builder.name == name) return builder.build({std::move(from), clipper}, OptionValues(builder.options));
    }
    return {};
  }
  Bvh reinserted(Bvh from) const {
    return optimise_reinsertion(std::move(from), OptionValues(optimisers().front().options), {});
  }
};

template <class Stage>
void add(const std::string& name, const std::shared_ptr<const Work>& work, Stage&& stage) {
  const auto run = [=](benchmark::State& state) {
    with_threads(static_cast<int>(state.range(0)), [&] {
      for (auto _ : state) stage(state, *work);
    });
    const double all = static_cast<double>(work->references.size()) * static_cast<double>(state.iterations());
    state.counters["per_triangle"] = benchmark::Counter(all, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  };
  benchmark::RegisterBenchmark(name.c_str(), run)->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);
}

/// A copy that is not timed.
template <class T>
T copy_of(benchmark::State& state, const T& from) {
  state.PauseTiming();
  T copy = from;
  state.ResumeTiming();
  return copy;
}

void add_all() {
  const auto work = std::make_shared<const Work>();
  add("references", work, [](benchmark::State&, const Work& w) {
    benchmark::DoNotOptimize(make_references(w.geometries).references.data());
  });
  add("early_split_auto", work, [](benchmark::State&, const Work& w) {
    benchmark::DoNotOptimize(split_automatically({w.geometries, w.references, w.clipper, {}}).references.data());
  });
  for (const char* builder : {"binned_sah", "spatial_split", "ploc", "lbvh"}) {
    add(builder, work, [builder](benchmark::State& state, const Work& w) {
      benchmark::DoNotOptimize(w.build(builder, copy_of(state, w.references)).nodes.data());
    });
  }
  add("reinsertion", work, [](benchmark::State& state, const Work& w) {
    benchmark::DoNotOptimize(w.reinserted(copy_of(state, w.bvh)).nodes.data());
  });
  add("collapse", work, [](benchmark::State&, const Work& w) {
    benchmark::DoNotOptimize(WideCollapse(w.bvh, w.geometries, 8, {}).cost());
  });
  add("collapse_and_write", work, [](benchmark::State&, const Work& w) {
    benchmark::DoNotOptimize(make_wide_bvh<8>(w.bvh, w.geometries).nodes.data());
  });
}

}  // namespace
}  // namespace kerf

int main(int argc, char** argv) { return kerf::run_benchmarks(argc, argv, kerf::add_all); }
