#include "kerf/study/inspect.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "kerf/base/error.h"
#include "kerf/base/parallel.h"
#include "kerf/render/picture_rays.h"
#include "kerf/render/render_scene.h"
#include "kerf/scene/pipeline.h"
#include "kerf/study/end_point_overlap.h"
#include "kerf/study/inspect_rays.h"
#include "kerf/study/primitive_numbers.h"

namespace kerf {
namespace {

constexpr double kShares[] = {0.1, 0.25, 0.5, 0.75, 0.9, 1};
constexpr double kCostlyShare = 0.5;
constexpr const char *kPlain = "binned_sah", *kSplit = "early_split(auto)+binned_sah";
constexpr size_t kMostTimedRays = 1 << 15;
constexpr size_t kMostPixels = 1 << 24;
constexpr size_t kBlock = 4096;

/// What of an InspectedPrimitive follows from the primitive alone.
struct Measures {
  double longest_edge = 0, thinness = 0, surface = 0, box_area = 0;
  double wasted() const { return box_area - surface; }
  double fill() const { return box_area > 0 ? surface / box_area : 0; }
};

/// The corners of a flat primitive, none of a sphere.
std::vector<Vec3d> corners_of(const Geometry& geometry, uint32_t primitive) {
  if (const auto* mesh = std::get_if<TriangleMesh>(&geometry.shapes)) {
    const Triangle t = mesh->triangle(primitive);
    return {to_double(t.a), to_double(t.b), to_double(t.c)};
  }
  if (const auto* shapes = std::get_if<Strided<Parallelogram>>(&geometry.shapes)) {
    const std::array<Vec3d, 4> corners = (*shapes)[primitive].corners();
    return {corners.begin(), corners.end()};
  }
  return {};
}

Measures measure(const Geometry& geometry, uint32_t primitive) {
  Measures m;
  m.box_area = surface_area(primitive_bounds(geometry, primitive));
  if (const auto* spheres = std::get_if<Strided<Sphere>>(&geometry.shapes)) {
    const double diameter = 2.0 * (*spheres)[primitive].radius;
    m.longest_edge = diameter;
    m.thinness = 1;
    m.surface = std::numbers::pi * diameter * diameter;
    return m;
  }
  const std::vector<Vec3d> corners = corners_of(geometry, primitive);
  for (size_t i = 0; i < corners.size(); ++i) {
    const Vec3d edge = corners[(i + 1) % corners.size()] - corners[i];
    m.longest_edge = std::max(m.longest_edge, std::sqrt(dot(edge, edge)));
  }
  const Vec3d twice = cross(corners[1] - corners[0], corners[2] - corners[0]);
  const double rectangle = std::sqrt(dot(twice, twice));  // longest edge times height
  m.thinness = m.longest_edge * m.longest_edge / rectangle;
  m.surface = corners.size() == 3 ? rectangle : 2 * rectangle;
  return m;
}

/// Of each primitive, by its number: the leaf slots that name it.
std::vector<uint32_t> count_references(const Scene& scene) {
  const PrimitiveNumbers numbers(scene.geometries());
  std::vector<uint32_t> references(numbers.size());
  scene.structure().visit_nodes([&](const NodeView& node) {
    for (const LeafSlot& slot : node.slots) ++references[numbers.number(slot)];
  });
  return references;
}

/// Works out the parts of an Inspection that look at primitives one by one.
class PrimitiveInspector {
 public:
  PrimitiveInspector(const SceneDescription& description, const Scene& scene, const RayTally& tally);

  void describe(Inspection& inspection, size_t top) const;

 private:
  uint64_t tests(size_t number) const { return of(tally_.tests, number); }
  uint64_t of(const PrimitiveTally& tally, size_t number) const {
    const LeafSlot slot = numbers_.slot(number);
    return tally[slot.geometry()][slot.primitive];
  }
  Measures measures(size_t number) const {
    const LeafSlot slot = numbers_.slot(number);
    return measure(geometries_[slot.geometry()], slot.primitive);
  }
  InspectedPrimitive named(size_t number) const;
  std::vector<InspectedPrimitive> all_named(std::span<const size_t> order, size_t top) const;
  TypicalPrimitive typical(std::span<const size_t> numbers) const;
  void describe_tests(Inspection& inspection, size_t top) const;
  void describe_boxes(Inspection& inspection, size_t top) const;

  const SceneDescription& description_;
  std::span<const Geometry> geometries_;
  const RayTally& tally_;
  PrimitiveNumbers numbers_;
  std::vector<size_t> kept_;  // numbers of primitives that can be hit
  std::vector<uint32_t> references_;
};

PrimitiveInspector::PrimitiveInspector(const SceneDescription& description, const Scene& scene, const RayTally& tally)
    : description_(description),
      geometries_(scene.geometries()),
      tally_(tally),
      numbers_(geometries_),
      references_(count_references(scene)) {
  for (size_t i = 0; i < numbers_.size(); ++i) {
    const LeafSlot slot = numbers_.slot(i);
    const Geometry& geometry = geometries_[slot.geometry()];
    if (find_defect(geometry, slot.primitive) != Defect::none || is_degenerate(geometry, slot.primitive)) continue;
    kept_.push_back(i);
  }
}

InspectedPrimitive PrimitiveInspector::named(size_t number) const {
  const LeafSlot slot = numbers_.slot(number);
  const Geometry& geometry = geometries_[slot.geometry()];
  const SceneObject& object = description_.objects[slot.geometry()];
  const Measures m = measures(number);
  InspectedPrimitive p;
  p.object = slot.geometry();
  p.primitive = slot.primitive;
  p.kind = kind_name(geometry);
  p.place = object.place;
  const auto* mesh = std::get_if<Mesh>(&object.shape);
  const uint32_t material =
      mesh != nullptr && slot.primitive < mesh->materials.size() ? mesh->materials[slot.primitive] : object.material;
  if (material < description_.materials.size()) p.material = description_.materials[material].name;
  p.corners = corners_of(geometry, slot.primitive);
  if (const auto* spheres = std::get_if<Strided<Sphere>>(&geometry.shapes)) {
    p.corners = {to_double((*spheres)[slot.primitive].center)};
    p.radius = (*spheres)[slot.primitive].radius;
  }
  p.longest_edge = m.longest_edge;
  p.thinness = m.thinness;
  p.surface = m.surface;
  p.box_area = m.box_area;
  p.references = references_[number];
  p.tests = tests(number);
  p.hits = of(tally_.hits, number);
  return p;
}

std::vector<InspectedPrimitive> PrimitiveInspector::all_named(std::span<const size_t> order, size_t top) const {
  std::vector<InspectedPrimitive> all;
  for (const size_t number : order.first(std::min(top, order.size()))) all.push_back(named(number));
  return all;
}

TypicalPrimitive PrimitiveInspector::typical(std::span<const size_t> numbers) const {
  if (numbers.empty()) return {};
  std::vector<double> values(numbers.size());
  const auto median = [&](auto&& value) {
    parallel_for(numbers.size(), kBlock, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) values[i] = value(measures(numbers[i]));
    });
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  };
  return {median([](const Measures& m) { return m.longest_edge; }),
          median([](const Measures& m) { return m.thinness; }), median([](const Measures& m) { return m.box_area; }),
          median([](const Measures& m) { return m.fill(); })};
}

void PrimitiveInspector::describe_tests(Inspection& inspection, size_t top) const {
  std::vector<size_t> order;
  for (const size_t number : kept_) {
    if (tests(number) > 0) order.push_back(number);
  }
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return tests(a) > tests(b); });
  size_t count = 0;
  uint64_t sum = 0;
  for (const double share : kShares) {
    while (count < order.size() && static_cast<double>(sum) < share * static_cast<double>(inspection.tests)) {
      sum += tests(order[count++]);
    }
    inspection.shares.push_back({share, count});
    if (share == kCostlyShare) inspection.typical_costly = typical(std::span(order).first(count));
  }
  inspection.most_tested = all_named(order, top);
}

void PrimitiveInspector::describe_boxes(Inspection& inspection, size_t top) const {
  std::vector<double> wasted(numbers_.size());
  for (const size_t number : kept_) {
    const Measures m = measures(number);
    wasted[number] = m.wasted();
    inspection.surface += m.surface;
    inspection.box_area += m.box_area;
  }
  std::vector<size_t> order = kept_;
  const auto last = order.begin() + static_cast<std::ptrdiff_t>(std::min(top, order.size()));
  std::partial_sort(order.begin(), last, order.end(),
                    [&](size_t a, size_t b) { return wasted[a] != wasted[b] ? wasted[a] > wasted[b] : a < b; });
  for (auto i = order.begin(); i != last; ++i) inspection.top_wasted += wasted[*i];
  inspection.most_wasted = all_named(order, top);
}

void PrimitiveInspector::describe(Inspection& inspection, size_t top) const {
  inspection.typical = typical(kept_);
  describe_boxes(inspection, top);
  if (inspection.is_attributed) describe_tests(inspection, top);
}

void describe_structure(Inspection& inspection, const Scene& scene) {
  const auto count = [](std::vector<uint64_t>& histogram, size_t at) {
    if (histogram.size() <= at) histogram.resize(at + 1);
    ++histogram[at];
  };
  size_t most = 0;
  scene.structure().visit_nodes([&](const NodeView& node) {
    if (!node.is_leaf) return;
    const size_t slots = node.slots.size();
    count(inspection.leaves_by_depth, node.depth);
    count(inspection.leaves_by_size, slots);
    inspection.leaf_area += surface_area(node.bounds) * static_cast<double>(slots);
    if (slots <= most) return;
    most = slots;
    inspection.largest_leaf = node.bounds;
  });
  inspection.root_area = surface_area(scene.bounds());
  Inspection::Bytes& bytes = inspection.bytes;
  for (const Geometry& geometry : scene.geometries()) {
    if (const auto* mesh = std::get_if<TriangleMesh>(&geometry.shapes)) {
      bytes.vertices += mesh->vertices.size() * sizeof(Vec3f);
      bytes.indices += mesh->triangles.size() * sizeof(TriangleCorners);
    } else {
      const bool is_sphere = std::holds_alternative<Strided<Sphere>>(geometry.shapes);
      bytes.shapes += primitive_count(geometry) * (is_sphere ? sizeof(Sphere) : sizeof(Parallelogram));
    }
  }
  const BuildReport& report = inspection.report;
  bytes.slots = std::min(report.bytes, report.references * sizeof(LeafSlot));
  bytes.nodes = report.bytes - bytes.slots;
}

uint64_t sum_of(const PrimitiveTally& tally) {
  uint64_t sum = 0;
  for (const std::vector<uint64_t>& geometry : tally) sum = std::accumulate(geometry.begin(), geometry.end(), sum);
  return sum;
}

RayCosts costs_of(const TraceCounts& counts, size_t rays) {
  const auto per_ray = [&](uint64_t n) { return rays > 0 ? static_cast<double>(n) / static_cast<double>(rays) : 0; };
  return {per_ray(counts.nodes), per_ray(counts.boxes), per_ray(counts.primitives), 0};
}

/// Evenly chosen of all, in order.
std::vector<Ray> timed_rays(std::span<const Ray> rays) {
  const size_t step = rays.size() / kMostTimedRays + 1;
  std::vector<Ray> some;
  for (size_t i = 0; i < rays.size(); i += step) some.push_back(rays[i]);
  return some;
}

std::optional<double> overlap_of(const Scene& scene, double seconds) {
  try {
    return end_point_overlap(scene, WorkLimit::seconds(seconds));
  } catch (const Error& error) {
    if (error.code() != ErrorCode::stopped) throw;
    return std::nullopt;
  }
}

size_t count_split(std::span<const uint32_t> references) {
  return static_cast<size_t>(std::count_if(references.begin(), references.end(), [](uint32_t n) { return n > 1; }));
}

/// The pipeline to try; empty: none.
std::string trial_of(const std::string& asked, const BuildReport& report) {
  if (asked == kNoTrial) return "";
  if (asked != kAutomaticTrial) return asked;
  return report.references_per_primitive > 1 ? kPlain : kSplit;
}

/// Builds the trial, counts its work and times it together with the structure inspected.
void run_trial(Inspection& inspection, const SceneDescription& description, const Scene& scene,
               const InspectOptions& options, std::span<const Ray> rays) {
  std::vector<const Scene*> scenes{&scene};
  Scene other;
  BuildOptions build = options.build;
  build.structure = trial_of(options.trial, inspection.report);
  if (!build.structure.empty() && parse_pipeline(build.structure).text() != inspection.report.structure) {
    other = build_scene(description, build);
    inspection.trial = {other.report(), costs_of(tally_rays(other, rays).counts, rays.size()),
                        overlap_of(other, options.overlap_seconds), count_split(count_references(other))};
    scenes.push_back(&other);
  }
  const std::vector<Ray> some = timed_rays(rays);
  const std::vector<double> seconds = time_rays(scenes, some);
  inspection.costs.seconds = seconds[0] / static_cast<double>(some.size());
  if (inspection.trial) inspection.trial->costs.seconds = seconds[1] / static_cast<double>(some.size());
}

Inspection inspect_here(const SceneDescription& description, const Camera& camera, const InspectOptions& options) {
  if (const std::string trial = trial_of(options.trial, {}); !trial.empty())
    parse_pipeline(trial);  // a wrong word costs no waiting
  if (size_t{options.width} * options.height > kMostPixels) {
    throw Error(ErrorCode::invalid_argument, "size", "more than 16,777,216 pixels");
  }
  const Scene scene = build_scene(description, options.build);
  const PictureRays picture = picture_rays(scene, camera, options.width, options.height);
  const RayTally tally = tally_rays(scene, picture.rays);
  Inspection inspection;
  inspection.objects = description.objects.size();
  inspection.report = scene.report();
  inspection.primary_rays = picture.primary;
  inspection.diffuse_rays = picture.rays.size() - picture.primary;
  inspection.hits = tally.hit_count;
  inspection.tests = tally.counts.primitives;
  inspection.costs = costs_of(tally.counts, picture.rays.size());
  inspection.is_attributed = sum_of(tally.tests) == inspection.tests;
  describe_structure(inspection, scene);
  PrimitiveInspector(description, scene, tally).describe(inspection, options.top);
  run_trial(inspection, description, scene, options, picture.rays);
  inspection.overlap = overlap_of(scene, options.overlap_seconds);
  return inspection;
}

}  // namespace

Inspection inspect(const SceneDescription& scene, const Camera& camera, const InspectOptions& options) {
  Inspection inspection;
  with_threads(options.build.threads, [&] { inspection = inspect_here(scene, camera, options); });
  return inspection;
}

}  // namespace kerf
