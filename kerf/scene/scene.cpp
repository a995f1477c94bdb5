#include "kerf/scene/scene.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>
#include <variant>
#include <vector>

#include "kerf/base/error.h"
#include "kerf/base/fp_environment.h"
#include "kerf/base/instruction_set.h"
#include "kerf/base/parallel.h"
#include "kerf/references/box_around.h"
#include "kerf/scene/pipeline.h"

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
    [](const void*, std::span<const Ray>, std::span<Hit>) { refuse_not_built(); },
    [](const void*, std::span<const Ray>, std::span<Hit>, TraceCounts&) { refuse_not_built(); },
    [](const void*, std::span<const Ray>, std::span<uint8_t>) { refuse_not_built(); },
    [](const void*, std::span<const Ray>, std::span<uint8_t>, TraceCounts&) { refuse_not_built(); },
};

// How long stages take, about, in shares of each other.
constexpr double kReferencesWeight = 2, kSplitterWeight = 20, kBuilderWeight = 40, kOptimiserWeight = 40,
                 kStructureWeight = 100, kLayoutWeight = 2, kMeasureWeight = 5;

double weight_of(const Stage& stage) {
  const std::string_view kind = stage.entry->kind;
  if (kind == "splitter") return kSplitterWeight;
  if (kind == "builder") return kBuilderWeight;
  if (kind == "optimiser") return kOptimiserWeight;
  return kind == "structure" ? kStructureWeight : 0;
}

/// The stages of a build, one after another: how long each takes, and which part of the progress is its own.
class Stages {
 public:
  Stages(const Pipeline& pipeline, WorkMeter& meter)
      : meter_(meter), all_(kReferencesWeight + kLayoutWeight + kMeasureWeight) {
    for (const Stage& stage : pipeline.stages) all_ += weight_of(stage);
  }

  void begin(std::string_view what, double weight) {
    begun_ += weight;
    meter_.begin_stage(what, begun_ / all_);
  }
  void begin(const Stage& stage) { begin(stage.entry->name, weight_of(stage)); }

  /// Seconds since the last call.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    return std::chrono::duration<double>(now - std::exchange(start_, now)).count();
  }

 private:
  WorkMeter& meter_;
  double all_, begun_ = 0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// The options of a builder or optimiser, with leaves as small as the layout needs them, and the costs of the layout
/// where none was given.
OptionValues options_for(const Stage& stage, const LayoutEntry& layout, const std::optional<TreeCosts>& costs) {
  OptionValues options = stage.options;
  const std::span<const OptionSpec> specs = stage.entry->options;
  const auto has = [&](std::string_view option) {
    return std::any_of(specs.begin(), specs.end(), [&](const OptionSpec& spec) { return spec.name == option; });
  };
  const std::string name(stage.entry->name);
  if (layout.leaf_size > 0 && has("leaf") && options["leaf"] > layout.leaf_size) {
    if (options.is_set("leaf")) {
      throw Error(ErrorCode::invalid_option, std::string(layout.name),
                  "it needs leaves of at most " + std::to_string(layout.leaf_size) + ": leave out 'leaf' of " + name);
    }
    options.set(name, "leaf", layout.leaf_size);
  }
  constexpr std::string_view kInner = "inner_cost", kLeaf = "leaf_cost", kPrimitive = "primitive_cost";
  const auto is_free = [&](std::string_view option) { return has(option) && !options.is_set(option); };
  if (costs && is_free(kInner) && is_free(kLeaf) && is_free(kPrimitive)) {
    options.set(name, kInner, costs->inner);
    options.set(name, kLeaf, costs->leaf);
    options.set(name, kPrimitive, costs->primitive);
  }
  return options;
}

/// Throws unless what the pipeline makes can be refitted.
void check_refits(const Pipeline& pipeline) {
  const MenuEntry& last = *pipeline.stages.back().entry;
  const auto* layout = std::get_if<const LayoutEntry*>(&last.entry);
  if (last.kind == "structure" || (layout != nullptr && !(*layout)->refits)) {
    throw Error(ErrorCode::invalid_option, std::string(last.name),
                "it cannot be refitted: only trees of boxes can, as bvh2, bvh8, skip_pointer or packets");
  }
}

size_t count_primitives(std::span<const Geometry> geometries) {
  size_t count = 0;
  for (const Geometry& geometry : geometries) count += primitive_count(geometry);
  return count;
}

}  // namespace

std::string room_sentence(std::span<const std::string> short_of_room) {
  std::string stages;
  for (const std::string& stage : short_of_room) stages += (stages.empty() ? "" : " and ") + stage;
  return "the limit of bytes left " + stages + " no room to cut as the options allow";
}

struct Scene::Added {
  std::vector<Geometry> geometries;
};

/// One finished build. Never moved: the structure's spans point into it.
struct Scene::Built {
  std::vector<Geometry> geometries;
  std::unique_ptr<const Structure> structure;
  Box3f bounds;
  BuildReport report;
  size_t kept = 0;               ///< primitives that are in the structure
  size_t most_references = 0;    ///< that the limit of bytes allows
  Structure* movable = nullptr;  ///< the same structure, if it is one that can be refitted
  std::optional<RestPose> rest;  ///< with BuildOptions::refittable

  Built(std::vector<Geometry> added, const Pipeline& pipeline, const BuildOptions& options, const WorkLimit& limit);
  StructureInput make_input(const Pipeline& pipeline, const BuildOptions& options, const WorkLimit& limit,
                            Stages& stages);
  const LayoutEntry& layout_for(const Pipeline& pipeline, size_t references, size_t bytes) const;
  void make_structure(StructureInput input, const Pipeline& pipeline, Stages& stages);
  void describe();
};

Scene::Built::Built(std::vector<Geometry> added, const Pipeline& pipeline, const BuildOptions& options,
                    const WorkLimit& limit)
    : geometries(std::move(added)) {
  Stages stages(pipeline, *limit.meter);
  report.structure = pipeline.text();
  StructureInput input = make_input(pipeline, options, limit, stages);
  make_structure(std::move(input), pipeline, stages);
  stages.begin("measure", kMeasureWeight);
  describe();
  report.peak_bytes = std::max(limit.meter->peak(), report.bytes);
  const auto& s = report.seconds;
  report.seconds.total = s.references + s.split + s.build + s.optimise + s.layout;
}

StructureInput Scene::Built::make_input(const Pipeline& pipeline, const BuildOptions& options, const WorkLimit& limit,
                                        Stages& stages) {
  report.sa_max = std::numeric_limits<double>::infinity();
  report.primitives = count_primitives(geometries);
  most_references = kerf::memory_need(pipeline, report.primitives, limit.bytes).most_references;
  stages.begin("references", kReferencesWeight);
  HeldBytes held(report.primitives * sizeof(Reference));
  PrimitiveReferences whole = make_references(geometries, options.skip_invalid, options.refittable);
  kept = whole.references.size();
  report.invalid = whole.invalid;
  report.degenerate = whole.degenerate;
  bounds = box_around(whole.references);
  report.seconds.references = stages.lap();

  const std::span<const Geometry> all = geometries;
  StructureInput input{all, std::move(whole.references), false, options.refittable, limit, std::move(held)};
  input.limit.check();
  if (const auto* splitter = std::get_if<const SplitterEntry*>(&pipeline.stages.front().entry->entry)) {
    stages.begin(pipeline.stages.front());
    SplitResult split = (*splitter)->split({all, input.references, geometry_clipper(all), limit, most_references},
                                           pipeline.stages.front().options);
    input.references = std::move(split.references);
    input.held.set(input.references.capacity() * sizeof(Reference));
    input.is_split = input.references.size() > kept;
    report.sa_max = split.limit;
    report.capped = split.capped;
    if (split.short_of_room) report.short_of_room.emplace_back((*splitter)->name);
    report.choice = std::move(split.choice);
  }
  report.seconds.split = stages.lap();
  return input;
}

/// Of a pipeline that names none.
const LayoutEntry& Scene::Built::layout_for(const Pipeline& pipeline, size_t references, size_t bytes) const {
  const bool has_room = kerf::memory_need(pipeline, report.primitives).most <= bytes;
  return pipeline.ends_with_preset && has_room ? preset_layout(references) : layouts().front();
}

/// What follows the splitter: a structure, or a builder, then any number of optimisers, then a layout or none. What a
/// maker is given it accounts for itself.
void Scene::Built::make_structure(StructureInput input, const Pipeline& pipeline, Stages& stages) {
  std::span<const Stage> makers = pipeline.stages;
  if (makers.front().entry->kind == "splitter") makers = makers.subspan(1);
  stages.begin(makers[0]);
  if (const auto* entry = std::get_if<const StructureEntry*>(&makers[0].entry->entry)) {
    structure = (*entry)->build(std::move(input), makers[0].options);
    report.seconds.build = stages.lap();
    return;
  }
  const auto* last = std::get_if<const LayoutEntry*>(&makers.back().entry->entry);
  const LayoutEntry& layout =
      last != nullptr ? **last : layout_for(pipeline, input.references.size(), input.limit.bytes);
  if (pipeline.ends_with_preset) report.structure += "+" + std::string(layout.name);
  const OptionValues layout_options = last != nullptr ? makers.back().options : OptionValues(layout.options);
  if (last != nullptr) makers = makers.first(makers.size() - 1);
  const auto& builder = *std::get<const BuilderEntry*>(makers[0].entry->entry);
  const std::span<const Geometry> all = geometries;
  input.held.release();
  BuildInput given(std::exchange(input.references, {}), geometry_clipper(all), input.limit);
  BuildNotes notes;
  given.most = most_references;
  given.notes = &notes;
  const bool only_triangles = std::all_of(all.begin(), all.end(), [](const Geometry& geometry) {
    return std::holds_alternative<TriangleMesh>(geometry.shapes);
  });
  const auto costs = only_triangles && layout.costs ? std::optional(layout.costs(layout_options)) : std::nullopt;
  Bvh bvh = builder.build(std::move(given), options_for(makers[0], layout, costs));
  if (notes.short_of_room) report.short_of_room.emplace_back(builder.name);
  HeldBytes tree(bvh.bytes());
  input.is_split = bvh.slots.size() > kept;  // some builders split
  if (input.is_split) mark_repeated(bvh, geometries);
  report.seconds.build = stages.lap();
  for (const Stage& stage : makers.subspan(1)) {
    stages.begin(stage);
    const auto& optimiser = *std::get<const OptimiserEntry*>(stage.entry->entry);
    tree.release();
    bvh = optimiser.optimise(std::move(bvh), options_for(stage, layout, costs), input.limit);
    tree.set(bvh.bytes());
  }
  report.seconds.optimise = stages.lap();
  stages.begin(layout.name, kLayoutWeight);
  if (input.refittable) rest.emplace(bvh, geometries, find_left_out(geometries), kept);
  const HeldBytes of_rest(rest ? rest->report().bytes : 0);
  std::unique_ptr<Structure> made = layout.make(std::move(bvh), input, layout_options);
  movable = made.get();
  structure = std::move(made);
  report.seconds.layout = stages.lap();
}

/// Reporting is not building, so no watch runs.
void Scene::Built::describe() {
  const StructureStatistics statistics = measure(*structure);
  report.references = statistics.references;
  report.references_per_primitive =
      kept > 0 ? static_cast<double>(statistics.references) / static_cast<double>(kept) : 0;
  report.bytes = structure->bytes();
  report.nodes = statistics.nodes;
  report.leaves = statistics.leaves;
  report.depth = statistics.depth;
  report.largest_leaf = statistics.largest_leaf;
  report.sah_cost = statistics.cost;
  if (rest) rest->set_built(statistics.cost, structure->refit_bytes());
  report.tree_hash = structure->hash();
  report.instruction_set = structure->instruction_set();
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
  if (options.refittable) check_refits(pipeline);
  chosen_instruction_set();  // throws where it is none, whatever the structure
  const size_t needed = memory_need(options).least;
  if (needed > options.limit.bytes) options.limit.check(needed);
  WorkMeter meter(options.progress);
  WorkLimit limit = options.limit;
  limit.meter = &meter;
  std::unique_ptr<Built> built;
  const auto build_all = [&] {
    const StandardFloat standard;
    const LimitScope scope(&limit);
    meter.tell(true);
    built = std::make_unique<Built>(added_ ? added_->geometries : std::vector<Geometry>{}, pipeline, options, limit);
    meter.end();
    meter.tell(true);
    limit.check();
  };
  try {
    with_threads(options.threads, build_all);
  } catch (const Error&) {
    meter.rethrow();
    throw;
  }
  built_ = std::move(built);
  table_ = &built_->structure->table();
  data_ = built_->structure->data();
  return built_->report;
}

const RefitReport& Scene::refit(std::span<const Geometry> moved, int threads) {
  if (built_ == nullptr) refuse_not_built();
  if (!built_->rest) {
    throw Error(ErrorCode::invalid_option, "refit", "the scene was not built for it: set `refittable` of BuildOptions");
  }
  with_threads(threads, [&] {
    const StandardFloat standard;
    built_->bounds = built_->rest->refit(*built_->movable, built_->geometries, moved);
    std::copy(built_->geometries.begin(), built_->geometries.end(), added_->geometries.begin());
  });
  return built_->rest->report();
}

const RefitReport& Scene::refit(int threads) { return refit(geometries(), threads); }

MemoryNeed Scene::memory_need(const BuildOptions& options) const {
  const size_t primitives = added_ ? count_primitives(added_->geometries) : 0;
  MemoryNeed need = kerf::memory_need(parse_pipeline(options.structure), primitives);
  if (options.refittable) need.most = MemoryNeed::kUnbounded;  // what refits keep depends on how primitives lie
  return need;
}

const BuildReport& Scene::report() const {
  if (built_ == nullptr) refuse_not_built();
  return built_->report;
}

const Structure& Scene::structure() const {
  if (built_ == nullptr) refuse_not_built();
  return *built_->structure;
}

std::span<const Geometry> Scene::geometries() const {
  if (built_ == nullptr) refuse_not_built();
  return built_->geometries;
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

}  // namespace kerf
