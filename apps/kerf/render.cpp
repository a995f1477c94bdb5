// kerf render: a picture of a scene, path-traced or of what each pixel's ray hits.

#include <fmt/core.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>

#include "apps/kerf/command.h"
#include "apps/kerf/progress_bar.h"
#include "apps/kerf/scene_input.h"
#include "kerf/base/error.h"
#include "kerf/base/nearest_word.h"
#include "kerf/io/image_write.h"
#include "kerf/render/bare_model.h"
#include "kerf/render/compare.h"
#include "kerf/render/path_tracer.h"
#include "kerf/render/views.h"
#include "kerf/scene/pipeline.h"

namespace kerf::app {
namespace {

using Json = nlohmann::ordered_json;

/// What the options were set to.
struct Arguments : SceneArguments {
  std::string output, view = std::string(kBeauty), size = "960x640", compare;
  // Only where they were given: a view of rays' hits has no use for them.
  std::optional<uint32_t> samples, seed;
  std::optional<float> exposure;
};

constexpr uint32_t kDefaultSamples = 32;

/// What is drawn: a debug view, or none for the path-traced picture.
const ViewEntry* find_view(const std::string& name) {
  if (name == kBeauty) return nullptr;
  std::vector<std::string_view> names = {kBeauty};
  for (const ViewEntry& entry : views()) {
    if (entry.name == name) return &entry;
    names.push_back(entry.name);
  }
  throw Error(ErrorCode::invalid_option, "--view", fmt::format("unknown view '{}'{}", name, suggestion(name, names)));
}

/// Finds mistakes in the words before any work is done.
void check_words(const Arguments& a, const ViewEntry* view, uint32_t width, uint32_t height) {
  const auto refuse = [](const char* option, const std::string& sentence) {
    throw Error(ErrorCode::invalid_option, option, sentence);
  };
  if (!a.structure.empty()) parse_pipeline(a.structure);
  if (!a.compare.empty()) parse_pipeline(a.compare);
  const bool is_png = image_format(a.output) == ImageFormat::png;
  if (view != nullptr && a.samples) refuse("--spp", "a view of what rays hit has one ray a pixel");
  if (view != nullptr && a.seed) refuse("--seed", "a view of what rays hit is not random");
  if (a.exposure && (view != nullptr || !is_png)) refuse("--exposure", "it acts on a path-traced PNG only");
  if (a.exposure && !std::isfinite(*a.exposure)) refuse("--exposure", "it must be a number");
  if (is_png && uint64_t{width} * height * 3 + height > kMostPngBytes) {
    refuse("--size", fmt::format("{} pixels are too many for a PNG; write a PFM", a.size));
  }
  check_output(a.output);
  if (!a.json.empty() && a.json != "-") check_output(a.json);
}

/// A finished or interrupted picture.
struct Picture {
  Image image;  ///< as it is to be written
  bool complete = true;
  double seconds = 0;
  Json figures;
};

Picture render_beauty(const RenderScene& scene, const Camera& camera, const Arguments& a, uint32_t width,
                      uint32_t height) {
  ProgressBar bar(a.quiet);
  PathTracerResult result =
      render_paths(scene, camera,
                   {width, height, a.samples.value_or(kDefaultSamples), a.seed.value_or(0), a.threads, std::ref(bar)});
  if (result.invalid > 0 && !a.quiet) {
    fmt::print(stderr, "kerf: note: {} of {} paths gave no finite radiance and were left out\n", result.invalid,
               result.paths);
  }
  Picture picture;
  picture.figures = {{"samples", a.samples.value_or(kDefaultSamples)},
                     {"seed", a.seed.value_or(0)},
                     {"paths", result.paths},
                     {"rays", result.rays},
                     {"invalid_paths", result.invalid}};
  const bool as_values = image_format(a.output) != ImageFormat::png;
  picture.image =
      as_values ? std::move(result.radiance) : srgb_picture(std::move(result.radiance), a.exposure.value_or(0));
  picture.complete = result.complete;
  picture.seconds = result.seconds;
  return picture;
}

Picture render_debug_view(const Scene& scene, const Camera& camera, const Arguments& a, const ViewEntry& view,
                          uint32_t width, uint32_t height) {
  ProgressBar bar(a.quiet);
  ViewResult result = render_view(scene, camera, {view.view, width, height, a.threads, std::ref(bar)});
  const double rays = result.rays > 0 ? static_cast<double>(result.rays) : 1;
  Picture picture;
  picture.figures = {{"rays", result.rays},
                     {"hits", result.hits},
                     {"nodes_per_ray", static_cast<double>(result.counts.nodes) / rays},
                     {"triangles_per_ray", static_cast<double>(result.counts.primitives) / rays},
                     {"boxes_per_ray", static_cast<double>(result.counts.boxes) / rays}};
  const bool as_values = image_format(a.output) != ImageFormat::png;
  picture.image = as_values ? std::move(result.values) : displayed(view.view, result.values);
  picture.complete = result.complete;
  picture.seconds = result.seconds;
  return picture;
}

/// Says what the scene's structure is worth beside another one.
Json compare(const SceneInput& input, const Arguments& a, double aspect) {
  BuildOptions other = input.build;
  other.structure = a.compare;
  const BuildOptions both[] = {other, input.build};
  const std::vector<StructureCost> costs = compare_structures(input.description, input.camera, aspect, both);
  Json all = Json::array();
  for (const StructureCost& cost : costs) {
    const double nanoseconds = 1e9 * cost.seconds / static_cast<double>(cost.rays);
    if (!a.quiet) {
      fmt::print(stderr, "{}{}: {:.1f} nodes and {:.1f} triangles a ray, {:.0f} ns", &cost == &costs[0] ? "" : "; ",
                 cost.structure, cost.nodes_per_ray, cost.primitives_per_ray, nanoseconds);
    }
    all.push_back({{"structure", cost.structure},
                   {"references_per_primitive", cost.references_per_primitive},
                   {"rays", cost.rays},
                   {"nodes_per_ray", cost.nodes_per_ray},
                   {"triangles_per_ray", cost.primitives_per_ray},
                   {"nanoseconds_per_ray", nanoseconds}});
  }
  if (!a.quiet) fmt::print(stderr, ": {:.2f} times as fast\n", costs[0].seconds / costs[1].seconds);
  return all;
}

int render(Arguments a) {
  if (a.output.empty()) a.output = std::filesystem::path(a.input).filename().replace_extension(".png").string();
  const ViewEntry* view = find_view(a.view);
  const auto [width, height] = parse_size(a.size);
  const double aspect = static_cast<double>(width) / height;
  check_words(a, view, width, height);
  SceneInput input = read_input(a, aspect);
  watch_interrupts();
  if (view == nullptr && !input.description.is_lit) add_light(input.description, input.camera, input.build);
  const Json comparison = a.compare.empty() ? Json() : compare(input, a, aspect);
  const RenderScene scene = build_input(a, input);
  const BuildReport& report = scene.scene().report();
  if (!a.quiet) print_build_notes(report);
  const Picture picture = view != nullptr ? render_debug_view(scene.scene(), input.camera, a, *view, width, height)
                                          : render_beauty(scene, input.camera, a, width, height);
  ignore_interrupts();
  write_image(a.output, picture.image);
  if (!a.json.empty()) {
    Json all = {{"input", a.input}, {"output", a.output}, {"view", a.view},
                {"width", width},   {"height", height},   {"complete", picture.complete}};
    all.update(picture.figures);
    all["render_seconds"] = picture.seconds;
    if (!comparison.is_null()) all["comparison"] = comparison;
    all["scene"] = report_json(report);
    write_json(a.json, all);
  }
  if (!a.quiet) {
    fmt::print(stderr, "{} {} in {:.2f} s, built in {:.2f} s\n", a.output,
               picture.complete ? "written" : "interrupted, written as far as it was", picture.seconds,
               report.seconds.total);
  }
  return picture.complete ? kDone : kInterrupted;
}

}  // namespace

void add_render(CLI::App& app, std::function<int()>& run) {
  CLI::App* command = app.add_subcommand("render", "Renders a scene or a model into a picture.");
  command->footer(
      "Examples: kerf render room.yaml --spp 256\n"
      "          kerf render machine.glb -o machine.exr --eye 3,2,4 --look-at 0,0,0\n"
      "          kerf render sponza.ply -o depth.pfm --view depth --structure 'early_split(auto)+binned_sah'");
  auto a = std::make_shared<Arguments>();
  command->add_option("-o,--output", a->output,
                      "Picture to write: .png to look at, .exr or .pfm for the values themselves "
                      "(default: the input's name with .png, in this folder)");
  command->add_option("--size", a->size, "Width and height in pixels")->capture_default_str();
  command->add_option("--spp", a->samples, "Samples of each pixel (default: 32)")
      ->check(CLI::Range(1, 1 << 24))
      ->capture_default_str();
  command->add_option("--seed", a->seed, "Another number gives another noise (default: 0)");
  command->add_option("--exposure", a->exposure, "Stops by which a PNG is brightened (negative: darkened)")
      ->check(CLI::Range(-64.0, 64.0));
  command->add_option("--view", a->view, "beauty (path-traced), or a view of what rays hit; see kerf list")
      ->capture_default_str();
  command->add_option("--compare", a->compare, "Also say what rays cost in this structure, such as binned_sah");
  add_scene_options(*command, *a);
  add_camera_options(*command, *a);
  command->callback([a, &run] { run = [a] { return render(*a); }; });
}

}  // namespace kerf::app
