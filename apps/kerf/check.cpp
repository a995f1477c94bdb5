// kerf check: says what is wrong with a scene, without rendering it.

#include <fmt/core.h>

#include <memory>

#include "apps/kerf/command.h"
#include "apps/kerf/scene_input.h"
#include "kerf/render/lights.h"

namespace kerf::app {
namespace {

using Json = nlohmann::ordered_json;

int check(const SceneArguments& a) {
  SceneInput input = read_input(a, 1.5);
  const std::vector<std::string> notes = input.description.notes;
  const RenderScene scene = build_input(a, input);
  const BuildReport& report = scene.scene().report();
  if (!a.quiet) print_build_notes(report);
  const Lights lights(scene);
  const SceneDescription& description = scene.description();
  if (!a.json.empty()) {
    const Json all = {{"input", a.input},
                      {"name", description.name},
                      {"objects", description.objects.size()},
                      {"materials", description.materials.size()},
                      {"textures", description.textures.size()},
                      {"lights", lights.size()},
                      {"notes", notes},
                      {"scene", report_json(report)}};
    write_json(a.json, all);
  } else if (!a.quiet) {
    fmt::print("{}: good: {} objects, {} primitives ({} without area), {} materials, {} lights; {}\n", a.input,
               description.objects.size(), report.primitives, report.degenerate, description.materials.size(),
               lights.size(), report.structure);
  }
  return kDone;
}

}  // namespace

void add_check(CLI::App& app, std::function<int()>& run) {
  CLI::App* command =
      app.add_subcommand("check", "Reads and builds a scene or a model and says what is wrong with it.");
  command->footer("Example: kerf check room.yaml");
  auto a = std::make_shared<SceneArguments>();
  add_scene_options(*command, *a);
  add_camera_options(*command, *a);
  command->callback([a, &run] { run = [a] { return check(*a); }; });
}

}  // namespace kerf::app
