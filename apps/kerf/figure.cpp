// kerf figure: pictures of structures for papers: heat maps, boxes, wireframes.

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "apps/kerf/command.h"
#include "apps/kerf/progress_bar.h"
#include "apps/kerf/scene_input.h"
#include "kerf/base/error.h"
#include "kerf/base/nearest_word.h"
#include "kerf/io/image_write.h"
#include "kerf/scene/pipeline.h"
#include "kerf/study/figures/heat_figure.h"
#include "kerf/study/figures/leaves_figure.h"
#include "kerf/study/figures/levels_figure.h"
#include "kerf/study/figures/svg.h"
#include "kerf/study/figures/wireframe_figure.h"

namespace kerf::app {
namespace {

using Json = nlohmann::ordered_json;

/// What the options were set to.
struct Arguments : SceneArguments {
  std::string kind, output, rows, size;
  std::vector<std::string> inputs;
  std::optional<uint32_t> levels, boxes;
};

constexpr uint32_t kDefaultLevels = 4, kDefaultBoxes = 600;
constexpr double kGapShare = 40;  // of a picture's width lies between two

/// One scene's part of a figure.
struct Part {
  Drawing drawing;
  Json figures;
};

struct Kind {
  std::string_view name;
  const char* size;                    ///< of each picture, where none is given
  bool needs_input;                    ///< else it has a scene of its own
  std::vector<std::string> (*rows)();  ///< where none are given
  SceneDescription (*own_scene)();     ///< where no input is given
  Part (*draw)(SceneInput& input, const Arguments& a, std::span<const std::string> rows, const FigureOptions& options);
};

Part draw_heat(SceneInput& input, const Arguments&, std::span<const std::string> rows, const FigureOptions& options) {
  const std::vector<HeatRow> traced = trace_heat(input.description, input.camera, rows, options);
  Part part{heat_figure(traced), Json::array()};
  for (const HeatRow& row : traced) {
    part.figures.push_back(
        {{"row", row.row}, {"nodes_per_ray", row.nodes_per_ray}, {"triangles_per_ray", row.triangles_per_ray}});
  }
  return part;
}

Part draw_levels(SceneInput& input, const Arguments& a, std::span<const std::string> rows,
                 const FigureOptions& options) {
  return {levels_figure(input.description, rows, a.levels.value_or(kDefaultLevels), options), rows};
}

Part draw_leaves(SceneInput& input, const Arguments& a, std::span<const std::string> rows,
                 const FigureOptions& options) {
  return {leaves_figure(input.description, input.camera, rows, a.boxes.value_or(kDefaultBoxes), options), rows};
}

Part draw_wireframe(SceneInput& input, const Arguments& a, std::span<const std::string> rows,
                    const FigureOptions& options) {
  const std::string name = std::filesystem::path(input.description.name).stem().string();
  return {wireframe_figure(input.description, input.camera, rows.front(), a.inputs.size() > 1 ? name : "", options),
          rows};
}

const Kind kKinds[] = {
    {"heat", "480x320", true,
     [] {
       return std::vector<std::string>{"binned_sah", "early_split(auto)+binned_sah"};
     },
     nullptr, draw_heat},
    {"levels", "260x260", false, splitting_rows, crossing_triangles, draw_levels},
    {"leaves", "520x350", false, leaf_rows, scattered_triangles, draw_leaves},
    {"wireframe", "960x640", true, [] { return std::vector<std::string>{"binned_sah"}; }, nullptr, draw_wireframe},
};

const Kind& find_kind(const std::string& name) {
  std::vector<std::string_view> names;
  for (const Kind& kind : kKinds) {
    if (kind.name == name) return kind;
    names.push_back(kind.name);
  }
  throw Error(ErrorCode::invalid_option, "KIND", fmt::format("unknown figure '{}'{}", name, suggestion(name, names)));
}

/// Finds mistakes in the words before any work is done; returns the rows.
std::vector<std::string> check_words(const Arguments& a, const Kind& kind) {
  const auto refuse = [](const char* option, const std::string& sentence) {
    throw Error(ErrorCode::invalid_option, option, sentence);
  };
  if (a.levels && kind.name != "levels") refuse("--levels", "only a figure of levels has them");
  if (a.boxes && kind.name != "leaves") refuse("--boxes", "only a figure of leaves has them");
  if (kind.needs_input && a.inputs.empty()) refuse("INPUT", fmt::format("a figure '{}' needs a scene", kind.name));
  std::vector<std::string> rows = a.rows.empty() ? kind.rows() : split_pipeline_list(a.rows);
  for (const std::string& row : rows) parse_pipeline(row);
  if (kind.name == "wireframe" && rows.size() > 1) refuse("--rows", "a wireframe looks the same in all of them");
  const bool is_svg = check_drawing_path(a.output);
  const bool is_flat = kind.name == "levels" || (kind.name == "leaves" && a.inputs.empty());
  if (is_svg && !is_flat) {
    refuse("--output", "it holds pictures of pixels; write it as .png");
  }
  check_output(a.output);
  if (!a.json.empty() && a.json != "-") check_output(a.json);
  return rows;
}

SceneInput read_part(const Arguments& a, const Kind& kind, size_t index, double aspect) {
  if (a.inputs.empty()) return {kind.own_scene(), {}, {}};
  SceneArguments one = a;
  one.input = a.inputs[index];
  SceneInput input = read_input(one, aspect);
  input.description.name = one.input;
  return input;
}

/// Draws all parts, wireframes side by side and other figures below each other.
Part draw(const Arguments& a, const Kind& kind, std::span<const std::string> rows, FigureOptions options) {
  Part all{{}, Json::array()};
  const size_t count = std::max<size_t>(a.inputs.size(), 1);
  ProgressBar bar(a.quiet);
  for (size_t i = 0; i < count; ++i) {
    SceneInput input = read_part(a, kind, i, static_cast<double>(options.width) / options.height);
    options.progress = part_of(std::ref(bar), i, count);
    Part part = kind.draw(input, a, rows, options);
    all.figures.push_back(
        {{"input", a.inputs.empty() ? Json() : Json(a.inputs[i])}, {"rows", std::move(part.figures)}});
    const bool is_beside = kind.name == "wireframe";
    const double gap = i > 0 && is_beside ? options.width / kGapShare : 0;
    all.drawing.place({is_beside ? all.drawing.width + gap : 0, is_beside ? 0 : all.drawing.height},
                      std::move(part.drawing));
  }
  return all;
}

int figure(Arguments a) {
  const Kind& kind = find_kind(a.kind);
  if (a.output.empty()) a.output = fmt::format("{}.png", kind.name);
  const auto [width, height] = parse_size(a.size.empty() ? kind.size : a.size);
  const std::vector<std::string> rows = check_words(a, kind);
  watch_interrupts();
  try {
    const Part part = draw(a, kind, rows, {width, height, a.threads, a.skip_invalid, {}});
    ignore_interrupts();
    // Text and lines are drawn in twice the pixels where there is nothing else.
    write_drawing(a.output, part.drawing, part.drawing.is_vector() ? 2 : 1);
    if (!a.json.empty()) {
      write_json(a.json, {{"kind", kind.name}, {"output", a.output}, {"scenes", part.figures}});
    }
  } catch (const Error& error) {
    if (error.code() != ErrorCode::stopped || !interrupted()) throw;
    if (!a.quiet) fmt::print(stderr, "kerf: interrupted; {} was not written\n", a.output);
    return kInterrupted;
  }
  if (!a.quiet) fmt::print(stderr, "{} written\n", a.output);
  return kDone;
}

}  // namespace

void add_figure(CLI::App& app, std::function<int()>& run) {
  CLI::App* command = app.add_subcommand("figure", "Draws structures as in papers: heat maps, boxes, wireframes.");
  command->footer(
      "Examples: kerf figure heat sponza.ply --rows binned_sah,'early_split(auto)+binned_sah' -o heat.png\n"
      "          kerf figure levels -o levels.svg\n"
      "          kerf figure leaves room.yaml --rows kd_sah,binned_sah --boxes 1000\n"
      "          kerf figure wireframe bunny.ply engine.ply --size 640x640 -o models.png");
  auto a = std::make_shared<Arguments>();
  command
      ->add_option("kind", a->kind,
                   "heat: nodes and triangles of each pixel's ray, for each row\n"
                   "levels: the boxes of each level of each row's tree\n"
                   "leaves: the leaf boxes of each row's structure\n"
                   "wireframe: each scene shaded, with the edges of its triangles")
      ->type_name("KIND")
      ->required();
  add_scene_options(*command, *a);
  command->remove_option(command->get_option("input"));        // more than one, or none
  command->remove_option(command->get_option("--structure"));  // rows say it
  command->add_option("input", a->inputs, "YAML scenes or models; levels and leaves have an example of their own")
      ->type_name("INPUT");
  command->add_option("-o,--output", a->output,
                      "Picture to write, .png, or .svg for levels and flat leaves (default: KIND.png, in this folder)");
  command->add_option("--rows", a->rows, "Pipelines, separated by commas; see kerf list")->type_name("PIPELINE,...");
  command->add_option("--size", a->size, "Width and height of each picture in the figure, in pixels");
  command->add_option("--levels", a->levels, "Levels to show, from the root on (default: 4)")->check(CLI::Range(1, 32));
  command
      ->add_option("--boxes", a->boxes, "Show the leaf boxes seen through so many points of the picture (default: 600)")
      ->check(CLI::Range(1, 1 << 24));
  add_camera_options(*command, *a);
  command->callback([a, &run] { run = [a] { return figure(*a); }; });
}

}  // namespace kerf::app
