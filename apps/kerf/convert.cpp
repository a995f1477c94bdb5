// kerf convert: the triangles of any model as PLY.

#include <fmt/core.h>

#include <memory>

#include "apps/kerf/command.h"
#include "kerf/io/model.h"
#include "kerf/io/ply_write.h"

namespace kerf::app {
namespace {

/// What the options were set to.
struct Arguments {
  std::string input, output, json;
  int threads = 0;
  bool quiet = false;
};

int convert(const Arguments& a) {
  check_ply_name(a.output);
  check_output(a.output);
  const Model model = read_model(a.input);
  if (!a.quiet) {
    for (const std::string& note : model.notes) fmt::print(stderr, "kerf: note: {}\n", note);
  }
  ignore_interrupts();
  write_ply(a.output, model.mesh);
  if (!a.json.empty()) {
    write_json(a.json, {{"input", a.input},
                        {"output", a.output},
                        {"triangles", model.mesh.triangles.size()},
                        {"vertices", model.mesh.vertices.size()},
                        {"notes", model.notes}});
  }
  if (!a.quiet) fmt::print(stderr, "{} written: {} triangles\n", a.output, model.mesh.triangles.size());
  return kDone;
}

}  // namespace

void add_convert(CLI::App& app, std::function<int()>& run) {
  CLI::App* command = app.add_subcommand("convert", "Writes the triangles of a model as PLY, all parts in one mesh.");
  command->footer("Example: kerf convert machine.glb machine.ply");
  auto a = std::make_shared<Arguments>();
  command->add_option("input", a->input, "A model (.ply, .obj, .stl, .glb, .gltf and more)")->required();
  command->add_option("output", a->output, "PLY file to write")->required();
  command->add_option("--threads", a->threads, "Accepted, as by every command; there is nothing to share")
      ->check(CLI::Range(0, 4096));
  command->add_option("--json", a->json, "Write figures to this file; '-' is standard output");
  command->add_flag("--quiet", a->quiet, "No messages");
  command->callback([a, &run] { run = [a] { return convert(*a); }; });
}

}  // namespace kerf::app
