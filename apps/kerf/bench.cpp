// kerf bench: Kerf beside Embree.

#include <fmt/core.h>

#include <filesystem>
#include <memory>

#include "apps/kerf/bench_session.h"
#include "apps/kerf/command.h"
#include "kerf/base/error.h"
#include "kerf/scene/pipeline.h"
#include "kerf/study/models/models.h"

namespace kerf::app {
namespace {

[[noreturn]] void refuse(const char* option, const std::string& sentence) {
  throw Error(ErrorCode::invalid_option, option, sentence);
}

/// Mistakes in the words are found before any work is done.
void check_words(const BenchArguments& a) {
  if (a.inputs.empty() && a.growth.empty()) refuse("input", "give a scene or a model, or --growth");
  if (a.growth.empty() && a.up_to) refuse("--up-to", "it is for --growth");
  if (!a.growth.empty() && !a.inputs.empty()) refuse("--growth", "it has scenes of its own: give no input");
  if (!a.growth.empty() && (a.eye || a.look_at || a.up || a.fov)) {
    refuse("--growth", "its scenes have cameras of their own");
  }
  if (!a.growth.empty()) check_model_name(a.growth);
  is_against_embree(a.against);
  if (!a.thread_counts.empty()) parse_threads(a.thread_counts);
  if (!a.turn.empty()) parse_turns(a.turn);
  if (!a.rays.empty()) parse_kinds(a.rays);
  if (!a.size.empty()) parse_size(a.size);
  for (const std::string& row : rows_of(a.rows)) parse_pipeline(row);
  for (const std::string& input : a.inputs) {
    if (!std::filesystem::exists(input)) throw Error(ErrorCode::file, input, "there is no such file");
  }
  if (!a.json.empty() && a.json != "-") check_output(a.json);
}

int run_bench(const BenchArguments& a) {
  check_words(a);
  watch_interrupts();
  BenchSession session(a);
  try {
    session.run();
  } catch (...) {
    if (session.has_results()) session.write();  // what is finished is not lost
    throw;
  }
  const bool is_complete = !interrupted();
  session.write();
  return is_complete ? kDone : kInterrupted;
}

void add_options(CLI::App& command, BenchArguments& a) {
  command.add_option("inputs", a.inputs,
                     "YAML scenes or models; a model is seen from its row in a cameras.tsv beside it");
  command.add_option("--against", a.against, "embree, or none (default: embree, where it was found)");
  command.add_option("--rows", a.rows,
                     "Pipelines of Kerf's, separated by commas; see kerf list (default: the presets, each as it is and "
                     "with the wide layouts that there are)");
  command.add_option(
      "--rays", a.rays,
      fmt::format("Kinds of rays: primary, shadow, ambient_occlusion, diffuse (default: {})", kBenchRays));
  command.add_option("--size", a.size,
                     fmt::format("Width and height of the picture whose rays are traced (default: {})", kBenchSize));
  command.add_option("--turn", a.turn,
                     "Turns each scene by 30 degrees about x, y, z or all three: xyz; a list, in which straight is the "
                     "scene as it stands (default: straight)");
  command.add_option("--growth", a.growth, "A model of kerf make, of 10000 triangles and ten times as many each time");
  command
      .add_option("--up-to", a.up_to,
                  fmt::format("With --growth: triangles of the largest (default: {:g})", kStudyUpTo))
      ->check(CLI::Range(1e4, 1e8));
  command.add_option(
      "--threads", a.thread_counts,
      "Threads that build and trace, of Kerf and of its rival; 0: all; a list measures each (default: 1)");
  command
      .add_option("--repeat", a.repeat,
                  fmt::format("Timed runs of each row, in turn with the others (default: {})", kBenchRepeat))
      ->check(CLI::Range(1, 1000));
  command.add_option("--limit-seconds", a.limit_seconds, "Give up a row whose build or whose rays take longer")
      ->check(positive);
  command
      .add_option("--limit-gigabytes", a.limit_gigabytes,
                  "Give up a row that needs more memory; one that can do with less cuts less, and says so")
      ->check(positive)
      ->capture_default_str();
  command.add_flag("--skip-invalid", a.skip_invalid, "Drop triangles that are not finite, instead of an error");
  command.add_option("--json", a.json, "Write figures to this file; '-' is standard output");
  command.add_flag("--quiet", a.quiet, "No messages and no progress");
}

}  // namespace

void add_bench(CLI::App& app, std::function<int()>& run) {
  CLI::App* command = app.add_subcommand(
      "bench",
      "Measures Kerf and Embree on the same rays: speed, build time, memory, hits, and which goals are reached.");
  command->footer(
      "Examples: kerf bench hall.ply --turn straight,xyz --json hall.json\n"
      "          kerf bench hall.ply --rows best,best+bvh2 --rays diffuse --threads 1,2\n"
      "          kerf bench --growth plant --up-to 1e7\n"
      "loop: one call for each ray in the picture's order; batch: one call for all; sorted, packets, stream: other "
      "ways\n"
      "to feed Embree, with rays that were sorted before the clock starts. docs/benchmarks.md says how it is "
      "measured.");
  auto a = std::make_shared<BenchArguments>();
  add_options(*command, *a);
  add_camera_options(*command, *a);
  command->callback([a, &run] {
    if (!a->up_to && !a->growth.empty()) a->up_to = kStudyUpTo;
    run = [a] { return run_bench(*a); };
  });
}

}  // namespace kerf::app
