#include "apps/kerf/scene_input.h"

#include <fmt/core.h>

#include <charconv>
#include <cmath>
#include <functional>

#include "apps/kerf/progress_bar.h"
#include "kerf/base/error.h"
#include "kerf/render/bare_model.h"
#include "kerf/scene/pipeline.h"
#include "kerf/study/camera_list.h"

namespace kerf::app {
namespace {

using Json = nlohmann::ordered_json;

/// "X,Y,Z". One word, not three as CLI11 would have it: that takes what stands behind it too.
Vec3d parse_vector(const char* option, const std::string& text) {
  Vec3d v;
  const char* at = text.data();
  const char* const end = at + text.size();
  for (uint32_t i = 0; i < 3; ++i) {
    if (i > 0 && (at == end || *at++ != ',')) break;
    const auto [rest, error] = std::from_chars(at, end, v[i]);
    if (error != std::errc() || !std::isfinite(v[i])) break;
    at = rest;
    if (i == 2 && at == end) return v;
  }
  throw Error(ErrorCode::invalid_option, option,
              fmt::format("'{}' is not a vector; write it as X,Y,Z, such as 0,1.5,-2", text));
}

void add_vector(CLI::App& command, const char* option, std::optional<Vec3d>& vector, const char* sentence) {
  command
      .add_option_function<std::string>(
          option, [option, &vector](const std::string& text) { vector = parse_vector(option, text); }, sentence)
      ->type_name("X,Y,Z");
}

Camera settled_camera(const SceneArguments& arguments, const SceneDescription& scene, double aspect) {
  if (arguments.fov && !(*arguments.fov > 0 && *arguments.fov < 180)) {
    throw Error(ErrorCode::invalid_option, "--fov", "it must lie between 0 and 180 degrees");
  }
  Camera camera;
  const std::optional<Camera> kept = scene.camera ? scene.camera : listed_camera(arguments.input);
  if (kept) {
    camera = *kept;
    camera.up = arguments.up.value_or(camera.up);
    camera.fov = arguments.fov.value_or(camera.fov);
  } else {
    camera =
        framing_camera(bounds_of(scene), aspect, arguments.up.value_or(camera.up), arguments.fov.value_or(camera.fov));
  }
  camera.look_at = arguments.look_at.value_or(camera.look_at);
  camera.eye = arguments.eye.value_or(camera.eye);
  return camera;
}

/// Says what is wrong with a camera before any work is done: a mistake in the words if words made it, else in the file.
void check_camera(const SceneArguments& arguments, const Camera& camera) {
  try {
    CameraRays(camera, 3, 2);
  } catch (const Error& error) {
    const bool is_usage = arguments.eye || arguments.look_at || arguments.up || arguments.fov;
    throw is_usage ? error : Error(ErrorCode::file, arguments.input, error.what());
  }
}

/// What the command line says goes before what the file says.
std::string settled_structure(const SceneArguments& arguments, const SceneDescription& scene) {
  if (!arguments.structure.empty()) return arguments.structure;
  if (scene.structure.empty()) return BuildOptions{}.structure;
  try {
    parse_pipeline(scene.structure);
  } catch (const Error& error) {
    throw Error(ErrorCode::file, scene.structure_place, error.what());
  }
  return scene.structure;
}

}  // namespace

Json choice_json(const std::optional<SplitChoice>& choice) {
  if (!choice) return {};
  Json curve = Json::array();
  for (const SplitChoice::Step& step : choice->curve) {
    curve.push_back({{"references_per_primitive", step.references_per_primitive}, {"cost", step.cost}});
  }
  return {{"reason", choice->reason}, {"curve", curve}};
}

std::array<uint32_t, 2> parse_size(const std::string& text) {
  std::array<uint32_t, 2> size{};
  const char* const end = text.data() + text.size();
  const auto width = std::from_chars(text.data(), end, size[0]);
  const bool has_x = width.ec == std::errc() && width.ptr != end && *width.ptr == 'x';
  const auto height = has_x ? std::from_chars(width.ptr + 1, end, size[1]) : width;
  const bool is_whole = has_x && height.ec == std::errc() && height.ptr == end;
  if (!is_whole || size[0] == 0 || size[1] == 0 || size[0] > 65536 || size[1] > 65536) {
    throw Error(
        ErrorCode::invalid_option, "--size",
        fmt::format("'{}' is not a size; write it as WIDTHxHEIGHT, such as 960x640, each from 1 to 65536", text));
  }
  return size;
}

void add_scene_options(CLI::App& command, SceneArguments& a) {
  command.add_option("input", a.input, "A YAML scene (.yaml) or a model (.ply, .obj, .stl, .glb, .gltf and more)")
      ->required();
  command.add_option("--structure", a.structure,
                     "How to find what rays hit; see kerf list (default: what the scene says, else balanced)");
  command.add_option("--threads", a.threads, "Threads to use; 0: all")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str();
  command.add_flag("--skip-invalid", a.skip_invalid, "Drop triangles that are not finite, instead of an error");
  command.add_option("--json", a.json, "Write figures to this file; '-' is standard output");
  command.add_flag("--quiet", a.quiet, "No messages and no progress");
}

void add_camera_options(CLI::App& command, SceneArguments& a) {
  add_vector(command, "--eye", a.eye,
             "Camera position (default: the scene's camera, that of a cameras.tsv beside it, or it is framed)");
  add_vector(command, "--look-at", a.look_at, "Point in the middle of the picture");
  add_vector(command, "--up", a.up, "Direction that is up (default: 0,1,0)");
  command.add_option("--fov", a.fov, "Vertical field of view in degrees (default: the scene's, or 45)");
}

SceneInput read_input(const SceneArguments& arguments, double aspect) {
  if (!arguments.structure.empty()) parse_pipeline(arguments.structure);  // costs no waiting
  SceneInput input;
  input.description = read_scene(arguments.input);
  if (!arguments.quiet) {
    for (const std::string& note : input.description.notes) fmt::print(stderr, "kerf: note: {}\n", note);
  }
  input.camera = settled_camera(arguments, input.description, aspect);
  input.build = {settled_structure(arguments, input.description), arguments.threads, arguments.skip_invalid};
  input.build.limit.cancelled = interrupt_flag();
  check_camera(arguments, input.camera);
  return input;
}

RenderScene build_input(const SceneArguments& arguments, SceneInput& input) {
  ProgressBar bar(arguments.quiet);
  BuildOptions build = input.build;
  build.progress = std::ref(bar);
  try {
    return RenderScene(std::move(input.description), build);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::invalid_argument) throw;
    throw Error(ErrorCode::file, arguments.input, error.what());
  }
}

Json limit_json(double x) { return std::isfinite(x) ? Json(x) : Json(std::isnan(x) ? "auto" : "inf"); }

Json report_json(const BuildReport& r) {
  return {{"structure", r.structure},
          {"primitives", r.primitives},
          {"invalid", r.invalid},
          {"degenerate", r.degenerate},
          {"references", r.references},
          {"references_per_primitive", r.references_per_primitive},
          {"sa_max", limit_json(r.sa_max)},
          {"capped", r.capped},
          {"short_of_room", r.short_of_room},
          {"split_choice", choice_json(r.choice)},
          {"bytes", r.bytes},
          {"peak_bytes", r.peak_bytes},
          {"nodes", r.nodes},
          {"leaves", r.leaves},
          {"depth", r.depth},
          {"largest_leaf", r.largest_leaf},
          {"sah_cost", r.sah_cost},
          {"tree_hash", fmt::format("{:016x}", r.tree_hash)},
          {"instruction_set", r.instruction_set},
          {"seconds",
           {{"references", r.seconds.references},
            {"split", r.seconds.split},
            {"build", r.seconds.build},
            {"optimise", r.seconds.optimise},
            {"layout", r.seconds.layout},
            {"total", r.seconds.total}}}};
}

void print_build_notes(const BuildReport& report) {
  if (!report.short_of_room.empty()) {
    fmt::print(stderr, "kerf: note: {}: raise it\n", room_sentence(report.short_of_room));
  }
  if (report.capped && !report.choice) {
    const bool is_short = !report.short_of_room.empty() && report.structure.starts_with(report.short_of_room.front());
    fmt::print(stderr, "kerf: note: {} raised the limit to {:.6g}\n",
               is_short ? "the limit of bytes" : "the cap on references", report.sa_max);
  }
  if (report.invalid > 0) fmt::print(stderr, "kerf: note: {} invalid triangles were dropped\n", report.invalid);
}

}  // namespace kerf::app
