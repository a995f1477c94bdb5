// kerf_bench_slab_tests: Kerf's box test beside those of the literature, each as conservative as the other: time per
// test, and instructions where the kernel lets a program count its own. Random boxes, and the boxes that the primary
// rays of a scene of KERF_SCENES meet in binned_sah's tree.
//
// Example: kerf_bench_slab_tests --benchmark_filter=sponza --benchmark_repetitions=9

#include <benchmark/benchmark.h>
#ifdef __linux__
#include <linux/perf_event.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <unistd.h>
#endif

#include <limits>
#include <map>
#include <memory>

#include "bench/benchmark_main.h"
#include "kerf/io/ply.h"
#include "kerf/scene/scene.h"
#include "kerf/trace/ray_box.h"
#include "kerf/trace/slab_tests.h"
#include "tests/support/random.h"
#include "tests/support/scenes.h"

namespace kerf::test {
namespace {

/// A box as the tests want it: see Sides.
struct Box {
  float sides[8];

  explicit Box(const Box3f& b) : sides{b.lower.x, b.lower.y, b.lower.z, 0, b.upper.x, b.upper.y, b.upper.z, 0} {}
};

/// Rays and, for each of them, the boxes that it is tested against.
struct Tests {
  Box3f bounds;
  std::vector<Ray> rays;
  std::vector<std::vector<Box>> boxes;

  size_t count() const {
    size_t sum = 0;
    for (const auto& list : boxes) sum += list.size();
    return sum;
  }
};

Tests random_tests() {
  constexpr size_t kRays = 1000, kBoxes = 100;
  Random random(1);
  Tests tests{{{-10, -10, -10}, {10, 10, 10}}, {}, {}};
  for (size_t i = 0; i < kRays; ++i) {
    tests.rays.push_back({.origin = 10.0F * random.vector(), .direction = random.vector()});
    std::vector<Box>& list = tests.boxes.emplace_back();
    for (size_t k = 0; k < kBoxes; ++k) {
      const Vec3f a = 10.0F * random.vector(), b = 10.0F * random.vector();
      list.emplace_back(Box3f{min(a, b), max(a, b)});
    }
  }
  return tests;
}

/// The children of all nodes that a ray enters.
Tests scene_tests(const std::string& folder, const SceneCamera& entry) {
  const Mesh mesh = read_ply(folder + "/" + entry.scene + ".ply");
  Scene scene;
  scene.add(TriangleMesh{std::span(mesh.vertices), std::span(mesh.triangles)});
  scene.build();
  Tests tests{scene.bounds(), camera_rays(entry.camera, 40, 27), {}};
  for (const Ray& ray : tests.rays) {
    const PreparedRay prepared(ray);
    const BoxRay box_ray(prepared, tests.bounds);
    std::vector<Box>& list = tests.boxes.emplace_back();
    std::vector<bool> is_entered;  // of the nodes above, by depth
    scene.structure().visit_nodes([&](const NodeView& node) {
      is_entered.resize(node.depth + 1);
      const Box box(node.bounds);
      float at;
      if (node.depth > 0 && !is_entered[node.depth - 1]) return;
      is_entered[node.depth] = box_ray.enters(box.sides, ray.t_min, ray.t_max, at);
      list.push_back(box);
    });
  }
  return tests;
}

/// Counts the instructions of this thread, where that is allowed.
class InstructionCounter {
 public:
#ifdef __linux__
  InstructionCounter() {
    perf_event_attr attributes{};
    attributes.type = PERF_TYPE_HARDWARE;
    attributes.size = sizeof attributes;
    attributes.config = PERF_COUNT_HW_INSTRUCTIONS;
    attributes.exclude_kernel = 1;
    file_ = static_cast<int>(syscall(SYS_perf_event_open, &attributes, 0, -1, -1, 0));
  }
  InstructionCounter(const InstructionCounter&) = delete;
  InstructionCounter& operator=(const InstructionCounter&) = delete;
  ~InstructionCounter() {
    if (file_ >= 0) close(file_);
  }
  /// Since the counter was made; none where counting is not allowed.
  std::optional<uint64_t> count() const {
    uint64_t count = 0;
    if (file_ < 0 || read(file_, &count, sizeof count) != sizeof count) return std::nullopt;
    return count;
  }

 private:
  int file_ = -1;
#else
  std::optional<uint64_t> count() const { return std::nullopt; }
#endif
};

template <class BoxTest>
void run(benchmark::State& state, const Tests& tests) {
  std::vector<BoxTest> box_rays;
  for (const Ray& ray : tests.rays) box_rays.emplace_back(PreparedRay(ray), tests.bounds);
  const InstructionCounter counter;
  const std::optional<uint64_t> before = counter.count();
  size_t entered = 0;
  for (auto _ : state) {
    entered = 0;
    for (size_t i = 0; i < tests.rays.size(); ++i) {
      for (const Box& box : tests.boxes[i]) {
        float entry = 0;
        entered += box_rays[i].enters(box.sides, tests.rays[i].t_min, tests.rays[i].t_max, entry) ? 1 : 0;
        benchmark::DoNotOptimize(entry);
      }
    }
    benchmark::DoNotOptimize(entered);
  }
  const auto count = static_cast<double>(tests.count());
  const double all = count * static_cast<double>(state.iterations());
  state.counters["tests"] = count;
  state.counters["entered"] = static_cast<double>(entered) / count;
  state.counters["time_per_test"] = benchmark::Counter(all, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  if (before) state.counters["instructions_per_test"] = static_cast<double>(*counter.count() - *before) / all;
}

void add(const std::string& name, const std::shared_ptr<const Tests>& tests) {
  const auto add_one = [&](const char* test, void (*f)(benchmark::State&, const Tests&)) {
    benchmark::RegisterBenchmark((name + "/" + test).c_str(), [=](benchmark::State& state) {
      f(state, *tests);
    })->Unit(benchmark::kMicrosecond);
  };
  add_one("ours", run<BoxRay>);
  add_one("naive", run<NaiveBoxRay>);
  add_one("williams", run<WilliamsBoxRay>);
  add_one("pluecker", run<PlueckerBoxRay>);
}

void add_all() {
  add("random", std::make_shared<const Tests>(random_tests()));
  const std::optional<std::string> folder = scenes_folder();
  if (!folder) return;
  for (const SceneCamera& entry : read_cameras(*folder)) {
    const bool is_small = entry.scene == "sponza" || entry.scene == "bunny" || entry.scene == "housing_coarse";
    if (entry.name == "1" && is_small) add(entry.scene, std::make_shared<const Tests>(scene_tests(*folder, entry)));
  }
}

}  // namespace
}  // namespace kerf::test

int main(int argc, char** argv) { return kerf::run_benchmarks(argc, argv, kerf::test::add_all); }
