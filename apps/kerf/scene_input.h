#pragma once

#include <CLI/CLI.hpp>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "kerf/render/camera.h"
#include "kerf/render/render_scene.h"

namespace kerf::app {

/// What commands that read a scene are told about it.
struct SceneArguments {
  std::string input, structure, json;
  std::optional<Vec3d> eye, look_at, up;
  std::optional<double> fov;
  int threads = 0;
  bool skip_invalid = false, quiet = false;
};

/// Adds the options for them to a command.
void add_scene_options(CLI::App& command, SceneArguments& arguments);
void add_camera_options(CLI::App& command, SceneArguments& arguments);

/// "WIDTHxHEIGHT", each from 1 to 65536. Throws Error (invalid_option).
std::array<uint32_t, 2> parse_size(const std::string& text);

/// A scene with all that its file may leave open settled.
struct SceneInput {
  SceneDescription description;
  Camera camera;
  BuildOptions build;
};

/// Reads the file, prints its notes, settles camera and structure: what was given on the command line goes before what
/// the file says, and that before the defaults.
SceneInput read_input(const SceneArguments& arguments, double aspect);

/// Builds what was read, with a progress bar, until an interrupt; its description is taken. What is wrong with the
/// file's values is an Error (file).
RenderScene build_input(const SceneArguments& arguments, SceneInput& input);

nlohmann::ordered_json report_json(const BuildReport& report);

/// The curve and its reason; null for none.
nlohmann::ordered_json choice_json(const std::optional<SplitChoice>& choice);

/// A surface area limit: JSON has no number for infinity, nor for one that was chosen for each part of the scene.
nlohmann::ordered_json limit_json(double sa_max);

/// Says on standard error what the build changed.
void print_build_notes(const BuildReport& report);

}  // namespace kerf::app
