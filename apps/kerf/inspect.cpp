// kerf inspect: says which primitives of a scene cost rays most, and why.

#include "kerf/study/inspect.h"

#include <fmt/core.h>

#include <memory>

#include "apps/kerf/command.h"
#include "apps/kerf/progress_bar.h"
#include "apps/kerf/scene_input.h"
#include "kerf/scene/pipeline.h"
#include "kerf/study/inspect_text.h"

namespace kerf::app {
namespace {

using Json = nlohmann::ordered_json;

struct Arguments : SceneArguments {
  std::string size = "320x240", trial = std::string(kAutomaticTrial);
  size_t top = InspectOptions{}.top;
};

Json vector_json(Vec3d v) { return {v.x, v.y, v.z}; }

Json primitives_json(const std::vector<InspectedPrimitive>& primitives, bool is_attributed) {
  Json all = Json::array();
  for (const InspectedPrimitive& p : primitives) {
    Json corners = Json::array();
    for (const Vec3d corner : p.corners) corners.push_back(vector_json(corner));
    Json one = {{"object", p.object},   {"primitive", p.primitive},       {"kind", p.kind},
                {"place", p.place},     {"material", p.material},         {"corners", corners},
                {"radius", p.radius},   {"longest_edge", p.longest_edge}, {"thinness", p.thinness},
                {"surface", p.surface}, {"box_area", p.box_area},         {"references", p.references},
                {"hits", p.hits}};
    one["tests"] = is_attributed ? Json(p.tests) : Json();
    all.push_back(one);
  }
  return all;
}

Json typical_json(const TypicalPrimitive& t) {
  return {{"longest_edge", t.longest_edge}, {"thinness", t.thinness}, {"box_area", t.box_area}, {"fill", t.fill}};
}

Json costs_json(const RayCosts& c) {
  return {{"nodes_per_ray", c.nodes},
          {"boxes_per_ray", c.boxes},
          {"triangles_per_ray", c.primitives},
          {"nanoseconds_per_ray", 1e9 * c.seconds}};
}

Json optional_json(const std::optional<double>& x) { return x ? Json(*x) : Json(); }

Json trial_json(const Inspection::Trial& trial) {
  return {{"scene", report_json(trial.report)},
          {"costs", costs_json(trial.costs)},
          {"end_point_overlap", optional_json(trial.overlap)},
          {"split", trial.split}};
}

Json inspection_json(const Arguments& a, const Inspection& i) {
  Json shares = Json::array();
  for (const TestShare& share : i.shares) shares.push_back({{"share", share.share}, {"primitives", share.primitives}});
  Json all = {{"input", a.input}, {"findings", findings(i)}, {"objects", i.objects}, {"scene", report_json(i.report)}};
  all["end_point_overlap"] = optional_json(i.overlap);
  all["rays"] = {{"primary", i.primary_rays}, {"diffuse", i.diffuse_rays}, {"hits", i.hits}, {"tests", i.tests}};
  all["costs"] = costs_json(i.costs);
  all["is_attributed"] = i.is_attributed;
  all["shares"] = shares;
  all["most_tested"] = primitives_json(i.most_tested, i.is_attributed);
  all["most_wasted"] = primitives_json(i.most_wasted, i.is_attributed);
  all["typical"] = typical_json(i.typical);
  all["typical_costly"] = typical_json(i.typical_costly);
  all["area"] = {{"surface", i.surface},
                 {"boxes", i.box_area},
                 {"most_wasted", i.top_wasted},
                 {"leaves_times_slots", i.leaf_area},
                 {"root", i.root_area}};
  all["leaves_by_depth"] = i.leaves_by_depth;
  all["leaves_by_size"] = i.leaves_by_size;
  all["bytes"] = {{"vertices", i.bytes.vertices},
                  {"indices", i.bytes.indices},
                  {"shapes", i.bytes.shapes},
                  {"slots", i.bytes.slots},
                  {"nodes", i.bytes.nodes}};
  all["trial"] = i.trial ? trial_json(*i.trial) : Json();
  return all;
}

int inspect(const Arguments& a) {
  const auto [width, height] = parse_size(a.size);
  InspectOptions options;
  if (a.trial != kAutomaticTrial && a.trial != kNoTrial) parse_pipeline(a.trial);
  options.trial = a.trial;
  if (!a.json.empty() && a.json != "-") check_output(a.json);
  const SceneInput input = read_input(a, static_cast<double>(width) / height);
  end_at_interrupts();
  ProgressBar bar(a.quiet);
  options.build = input.build;
  options.build.progress = std::ref(bar);
  options.width = width;
  options.height = height;
  options.top = a.top;
  const Inspection inspection = kerf::inspect(input.description, input.camera, options);
  if (!a.quiet) {
    print_build_notes(inspection.report);
    if (a.json != "-") fmt::print("{}", inspection_text(inspection));
  }
  if (!a.json.empty()) write_json(a.json, inspection_json(a, inspection));
  return kDone;
}

}  // namespace

void add_inspect(CLI::App& app, std::function<int()>& run) {
  CLI::App* command = app.add_subcommand(
      "inspect", "Says what is wrong with a scene: which triangles cost rays most, and how its structure looks.");
  command->footer(
      "Examples: kerf inspect atrium.glb\n"
      "          kerf inspect room.yaml --structure kd_sah --top 20 --json room.json");
  auto a = std::make_shared<Arguments>();
  command->add_option("--size", a->size, "Width and height in pixels of the picture whose rays are traced")
      ->capture_default_str();
  command->add_option("--top", a->top, "How many triangles to name")
      ->check(CLI::Range(0, 100000))
      ->capture_default_str();
  command
      ->add_option("--trial", a->trial,
                   "Also built, to see what the same rays cost there; 'auto': with splitting, or without where the "
                   "structure has it; 'none'")
      ->capture_default_str();
  add_scene_options(*command, *a);
  add_camera_options(*command, *a);
  command->callback([a, &run] { run = [a] { return inspect(*a); }; });
}

}  // namespace kerf::app
