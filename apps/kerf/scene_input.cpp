#include "apps/kerf/scene_input.h"

#include <fmt/core.h>

#include <cmath>

#include "kerf/base/error.h"
#include "kerf/render/bare_model.h"
#include "kerf/scene/pipeline.h"

namespace kerf::app {
namespace {

using Json = nlohmann::ordered_json;

Json number(double x) { return std::isfinite(x) ? Json(x) : Json("inf"); }

Vec3d vector_of(const std::vector<double>& v) { return {v[0], v[1], v[2]}; }

Camera settled_camera(const SceneArguments& arguments, const SceneDescription& scene, double aspect) {
  const bool has_fov = arguments.fov != 0;
  if (has_fov && !(arguments.fov > 0 && arguments.fov < 180)) {
    throw Error(ErrorCode::invalid_option, "--fov", "it must lie between 0 and 180 degrees");
  }
  Camera camera;
  if (scene.camera) {
    camera = *scene.camera;
    if (!arguments.up.empty()) camera.up = vector_of(arguments.up);
    if (has_fov) camera.fov = arguments.fov;
  } else {
    const Vec3d up = arguments.up.empty() ? camera.up : vector_of(arguments.up);
    camera = framing_camera(bounds_of(scene), aspect, up, has_fov ? arguments.fov : camera.fov);
  }
  if (!arguments.look_at.empty()) camera.look_at = vector_of(arguments.look_at);
  if (!arguments.eye.empty()) camera.eye = vector_of(arguments.eye);
  return camera;
}

/// Checked before the file is read where it is given, so that a misspelt word costs no waiting.
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

void add_scene_options(CLI::App& command, SceneArguments& a) {
  command.add_option("input", a.input, "A YAML scene (.yaml) or a model (.ply, .obj, .stl, .glb, .gltf and more)")
      ->required();
  command.add_option("--structure", a.structure,
                     "How to find what rays hit; see kerf list (default: what the scene says, else binned_sah)");
  command.add_option("--threads", a.threads, "Threads to use; 0: all")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str();
  command.add_flag("--skip-invalid", a.skip_invalid, "Drop triangles that are not finite, instead of an error");
  command.add_option("--json", a.json, "Write figures to this file; '-' is standard output");
  command.add_flag("--quiet", a.quiet, "No messages and no progress");
}

void add_camera_options(CLI::App& command, SceneArguments& a) {
  command.add_option("--eye", a.eye, "Camera position X,Y,Z (default: the scene's camera, or the model is framed)")
      ->delimiter(',')
      ->expected(3);
  command.add_option("--look-at", a.look_at, "Point in the middle of the picture X,Y,Z")->delimiter(',')->expected(3);
  command.add_option("--up", a.up, "Direction that is up X,Y,Z (default: 0,1,0)")->delimiter(',')->expected(3);
  command.add_option("--fov", a.fov, "Vertical field of view in degrees (default: the scene's, or 45)");
}

SceneInput read_input(const SceneArguments& arguments, double aspect) {
  if (!arguments.structure.empty()) parse_pipeline(arguments.structure);
  SceneInput input;
  input.description = read_scene(arguments.input);
  if (!arguments.quiet) {
    for (const std::string& note : input.description.notes) fmt::print(stderr, "kerf: note: {}\n", note);
  }
  input.camera = settled_camera(arguments, input.description, aspect);
  input.build = {settled_structure(arguments, input.description), arguments.threads, arguments.skip_invalid};
  CameraRays(input.camera, 3, 2);  // says what is wrong with it before any work is done
  return input;
}

Json report_json(const BuildReport& r) {
  return {{"structure", r.structure},
          {"primitives", r.primitives},
          {"invalid", r.invalid},
          {"degenerate", r.degenerate},
          {"references", r.references},
          {"references_per_primitive", r.references_per_primitive},
          {"sa_max", number(r.sa_max)},
          {"capped", r.capped},
          {"bytes", r.bytes},
          {"nodes", r.nodes},
          {"leaves", r.leaves},
          {"depth", r.depth},
          {"sah_cost", r.sah_cost},
          {"tree_hash", fmt::format("{:016x}", r.tree_hash)},
          {"seconds",
           {{"references", r.seconds.references},
            {"split", r.seconds.split},
            {"build", r.seconds.build},
            {"layout", r.seconds.layout},
            {"total", r.seconds.total}}}};
}

void print_build_notes(const BuildReport& report) {
  if (report.capped) fmt::print(stderr, "kerf: note: the cap on references raised sa_max to {:.6g}\n", report.sa_max);
  if (report.invalid > 0) fmt::print(stderr, "kerf: note: {} invalid triangles were dropped\n", report.invalid);
}

}  // namespace kerf::app
