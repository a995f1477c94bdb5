#include "kerf/scene/scene.h"

#include <chrono>
#include <limits>
#include <utility>
#include <variant>
#include <vector>

#include "kerf/base/error.h"
#include "kerf/base/fp_environment.h"
#include "kerf/base/parallel.h"
#include "kerf/scene/pipeline.h"
#include "kerf/trace/brute_force.h"
#include "kerf/trace/trace_bvh2.h"

namespace kerf {
namespace {

[[noreturn]] void refuse_not_built() {
  throw Error(ErrorCode::not_built, "scene", "it has not been built; call build() first");
}

constexpr TraceTable kNotBuilt = {
    [](const void*, const Ray&) -> Hit { refuse_not_built(); },
    [](const void*, const Ray&) -> bool { refuse_not_built(); },
    [](const void*, const Ray&, TraceCounts&) -> Hit { refuse_not_built(); },
    [](const void*, const Ray&, TraceCounts&) -> bool { refuse_not_built(); },
};

/// Seconds since the last call.
class Stopwatch {
 public:
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    return std::chrono::duration<double>(now - std::exchange(start_, now)).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

template <class Result, class F>
void run_batch(std::span<const Ray> rays, std::span<Result> results, int threads, F&& query) {
  if (rays.size() != results.size()) {
    throw Error(ErrorCode::invalid_argument, "batch",
                std::to_string(rays.size()) + " rays, but room for " + std::to_string(results.size()) + " results");
  }
  const auto run = [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) results[i] = query(rays[i]);
  };
  if (threads == 1) return run(0, rays.size());
  with_threads(threads, [&] { parallel_for(rays.size(), 1024, run); });
}

}  // namespace

struct Scene::Added {
  std::vector<Geometry> geometries;
};

/// One finished build. Never moved: the tracer's spans point into it.
struct Scene::Built {
  std::vector<Geometry> geometries;
  std::variant<Bvh2Tracer, BruteForce> tracer;
  const TraceTable* table = nullptr;
  Box3f bounds;
  BuildReport report;

  Built(std::vector<Geometry> added, const Pipeline& pipeline, bool skip_invalid);
  void build_tree(std::vector<Reference> references, const Stage& stage, Stopwatch& watch);
  const void* data() const {
    return std::visit([](const auto& t) -> const void* { return &t; }, tracer);
  }
};

Scene::Built::Built(std::vector<Geometry> added, const Pipeline& pipeline, bool skip_invalid)
    : geometries(std::move(added)) {
  Stopwatch watch;
  report.structure = pipeline.text();
  report.sa_max = std::numeric_limits<double>::infinity();
  for (const Geometry& geometry : geometries) report.primitives += primitive_count(geometry);
  PrimitiveReferences whole = make_references(geometries, skip_invalid);
  report.invalid = whole.invalid;
  report.degenerate = whole.degenerate;
  const size_t kept = whole.references.size();
  for (const Reference& reference : whole.references) bounds.extend(reference.bounds());
  report.seconds.references = watch.lap();

  std::vector<Reference> references = std::move(whole.references);
  const std::span<const Geometry> all = geometries;
  for (const Stage& stage : pipeline.stages) {
    const auto* splitter = std::get_if<const SplitterEntry*>(&stage.entry->entry);
    if (splitter == nullptr) continue;
    EarlySplitResult split = (*splitter)->split(references, geometry_clipper(all), stage.options);
    references = std::move(split.references);
    report.sa_max = std::min(report.sa_max, split.sa_max);
    report.capped = report.capped || split.capped;
  }
  report.references = references.size();
  report.references_per_primitive = kept > 0 ? static_cast<double>(references.size()) / static_cast<double>(kept) : 0;
  report.seconds.split = watch.lap();
  build_tree(std::move(references), pipeline.stages.back(), watch);
  const auto& s = report.seconds;
  report.seconds.total = s.references + s.split + s.build + s.layout;
}

void Scene::Built::build_tree(std::vector<Reference> references, const Stage& stage, Stopwatch& watch) {
  const auto* builder = std::get_if<const BuilderEntry*>(&stage.entry->entry);
  if (builder == nullptr) {
    std::vector<LeafSlot> slots;
    slots.reserve(references.size());
    for (const Reference& reference : references) slots.push_back({reference.geometry, reference.primitive});
    report.bytes = tracer.emplace<BruteForce>(geometries, slots).bytes();
    report.seconds.build = watch.lap();
    table = &brute_force_table();
    return;
  }
  Bvh bvh = (*builder)->build(std::move(references), stage.options);
  if (report.references_per_primitive > 1) mark_repeated(bvh, geometries);
  report.seconds.build = watch.lap();
  const BvhStatistics statistics = measure(bvh);
  report.nodes = statistics.nodes;
  report.leaves = statistics.leaves;
  report.depth = statistics.depth;
  report.sah_cost = statistics.sah_cost;
  report.tree_hash = tree_hash(bvh);
  watch.lap();  // reporting is not building
  Bvh2Tracer& bvh2 = tracer.emplace<Bvh2Tracer>();
  bvh2.layout = make_bvh2(std::move(bvh));
  bvh2.geometries = geometries;
  report.bytes = bvh2.layout.bytes();
  report.seconds.layout = watch.lap();
  table = &bvh2_table();
}

Scene::Scene() : added_(std::make_unique<Added>()), table_(&kNotBuilt) {}
Scene::~Scene() = default;

Scene::Scene(Scene&& other) noexcept
    : added_(std::move(other.added_)),
      built_(std::move(other.built_)),
      table_(std::exchange(other.table_, &kNotBuilt)),
      data_(std::exchange(other.data_, nullptr)) {}

Scene& Scene::operator=(Scene&& other) noexcept {
  added_ = std::move(other.added_);
  built_ = std::move(other.built_);
  table_ = std::exchange(other.table_, &kNotBuilt);
  data_ = std::exchange(other.data_, nullptr);
  return *this;
}

uint32_t Scene::add(Geometry geometry) {
  if (added_ == nullptr) added_ = std::make_unique<Added>();  // a scene that was moved from starts anew
  added_->geometries.push_back(geometry);
  return static_cast<uint32_t>(added_->geometries.size() - 1);
}

const BuildReport& Scene::build(const BuildOptions& options) {
  const Pipeline pipeline = parse_pipeline(options.structure);
  std::unique_ptr<const Built> built;
  with_threads(options.threads, [&] {
    const StandardFloat standard;
    built = std::make_unique<const Built>(added_ ? added_->geometries : std::vector<Geometry>{}, pipeline,
                                          options.skip_invalid);
  });
  built_ = std::move(built);
  table_ = built_->table;
  data_ = built_->data();
  return built_->report;
}

const BuildReport& Scene::report() const {
  if (built_ == nullptr) refuse_not_built();
  return built_->report;
}

Box3f Scene::bounds() const {
  if (built_ == nullptr) refuse_not_built();
  return built_->bounds;
}

Vec3f Scene::normal(const Hit& hit) const {
  if (built_ == nullptr) refuse_not_built();
  const StandardFloat standard;
  return hit ? unit_normal(built_->geometries[hit.geometry], hit.primitive, hit.u, hit.v) : Vec3f{};
}

void Scene::closest_hit(std::span<const Ray> rays, std::span<Hit> hits, int threads) const {
  run_batch(rays, hits, threads, [this](const Ray& ray) { return closest_hit(ray); });
}

void Scene::any_hit(std::span<const Ray> rays, std::span<uint8_t> hits, int threads) const {
  run_batch(rays, hits, threads, [this](const Ray& ray) { return static_cast<uint8_t>(any_hit(ray)); });
}

}  // namespace kerf
