// kerf make: a model out of a program, in any size.

#include <fmt/core.h>

#include <chrono>
#include <memory>

#include "apps/kerf/command.h"
#include "kerf/base/options.h"
#include "kerf/base/parallel.h"
#include "kerf/io/ply_write.h"
#include "kerf/study/models/models.h"

namespace kerf::app {
namespace {

using Json = nlohmann::ordered_json;

/// What the options were set to.
struct Arguments {
  std::string name, output, json;
  uint64_t triangles = 100'000;
  uint32_t seed = 0;
  int threads = 0;
  bool quiet = false;
};

std::string vector_text(Vec3d v) { return fmt::format("{},{},{}", to_text(v.x), to_text(v.y), to_text(v.z)); }

/// The words that give the other commands this camera.
std::string camera_words(const Camera& camera) {
  return fmt::format("--eye {} --look-at {} --up {} --fov {}", vector_text(camera.eye), vector_text(camera.look_at),
                     vector_text(camera.up), to_text(camera.fov));
}

Json vector_json(Vec3d v) { return {v.x, v.y, v.z}; }

int make(Arguments a) {
  if (a.output.empty()) a.output = a.name + ".ply";
  check_model_name(a.name);
  check_ply_name(a.output);
  check_output(a.output);
  const auto start = std::chrono::steady_clock::now();
  MadeModel model;
  with_threads(a.threads, [&] { model = make_model(a.name, a.triangles, a.seed); });
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  ignore_interrupts();
  write_ply(a.output, model.mesh);
  const std::string words = camera_words(model.camera);
  if (!a.json.empty()) {
    write_json(a.json, {{"model", a.name},
                        {"output", a.output},
                        {"seed", a.seed},
                        {"triangles", model.mesh.triangles.size()},
                        {"vertices", model.mesh.vertices.size()},
                        {"camera",
                         {{"eye", vector_json(model.camera.eye)},
                          {"look_at", vector_json(model.camera.look_at)},
                          {"up", vector_json(model.camera.up)},
                          {"fov", model.camera.fov}}},
                        {"camera_options", words},
                        {"make_seconds", seconds}});
  }
  if (!a.quiet) {
    fmt::print(stderr, "{} written: {} triangles, made in {:.2f} s\nTry: kerf render {} {}\n", a.output,
               model.mesh.triangles.size(), seconds, a.output, words);
  }
  return kDone;
}

}  // namespace

void add_make(CLI::App& app, std::function<int()>& run) {
  CLI::App* command = app.add_subcommand("make", "Makes a model of any size out of a program.");
  std::string names;
  for (const ModelEntry& entry : made_models()) names += fmt::format("\n  {:<10}{}", entry.name, entry.sentence);
  command->footer("Models:" + names + "\nExample: kerf make plant --triangles 1667578 --seed 1 -o plant.ply");
  auto a = std::make_shared<Arguments>();
  command->add_option("name", a->name, "The model; they stand below")->required();
  command->add_option("-o,--output", a->output,
                      "PLY file to write (default: the model's name with .ply, in this folder)");
  command
      ->add_option("--triangles", a->triangles,
                   "How many triangles, within 5 %; a model that cannot be so small is as small as it can be")
      ->check(CLI::Range(1, 0x7FFFFFFF))
      ->capture_default_str();
  command->add_option("--seed", a->seed, "Another number gives another model of the same kind")->capture_default_str();
  command->add_option("--threads", a->threads, "Threads to use; 0: all")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str();
  command->add_option("--json", a->json, "Write figures and the camera to this file; '-' is standard output");
  command->add_flag("--quiet", a->quiet, "No messages");
  command->callback([a, &run] { run = [a] { return make(*a); }; });
}

}  // namespace kerf::app
