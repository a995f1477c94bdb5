// kerf study: structures side by side.

#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <vector>

#include "apps/kerf/command.h"
#include "apps/kerf/study_session.h"
#include "apps/kerf/study_splitting.h"
#include "kerf/base/error.h"
#include "kerf/base/nearest_word.h"
#include "kerf/scene/pipeline.h"
#include "kerf/study/models/models.h"
#include "kerf/study/turn.h"

namespace kerf::app {
namespace {

[[noreturn]] void refuse(const char* option, const std::string& sentence) {
  throw Error(ErrorCode::invalid_option, option, sentence);
}

/// Where the scenes come from.
void check_scenes(const StudyArguments& a) {
  const bool has_own_scenes = a.is_paper || !a.growth.empty();
  const char* const own = a.is_paper ? "--paper" : "--growth";
  if (has_own_scenes && !a.inputs.empty()) refuse(own, "it has scenes of its own: give no input");
  if (!has_own_scenes && a.inputs.empty()) refuse("input", "give a scene or a model, --paper or --growth");
  if (a.is_paper && !a.growth.empty()) refuse("--growth", "it does not go with --paper");
  if (has_own_scenes && (a.eye || a.look_at || a.up || a.fov)) refuse(own, "its scenes have cameras of their own");
  if (a.is_paper && !a.turn.empty()) refuse("--turn", "--paper turns scenes by itself");
  if (!a.is_paper && a.seeds) refuse("--seeds", "it is for --paper");
  if (a.growth.empty() && a.up_to) refuse("--up-to", "it is for --growth");
  if (!a.growth.empty()) check_model_name(a.growth);
  if (!a.turn.empty() && !a.is_splitting) turn_by_name(a.turn);
  if (a.is_splitting && has_own_scenes) refuse("--splitting", fmt::format("it does not go with {}", own));
  if (a.no_determinism && !a.is_splitting) refuse("--no-determinism", "it is for --splitting");
  for (const std::string& input : a.inputs) {
    if (!std::filesystem::exists(input)) throw Error(ErrorCode::file, input, "there is no such file");
  }
}

void check_rays(const StudyArguments& a) {
  if (!(a.save_rays.empty() && a.load_rays.empty()) && a.inputs.size() != 1) {
    refuse(a.save_rays.empty() ? "--load-rays" : "--save-rays", "rays belong to one scene: give one input");
  }
  if (!a.load_rays.empty() && !(a.rays.empty() && a.save_rays.empty())) {
    refuse("--load-rays", "the rays are those of the file: leave out --rays and --save-rays");
  }
  if (!a.rays.empty()) parse_kinds(a.rays);
  if (!a.size.empty()) parse_size(a.size);
}

/// Mistakes in the words are found before any work is done.
void check_words(const StudyArguments& a) {
  check_scenes(a);
  check_rays(a);
  if (a.is_splitting) check_splitting(a);
  if (!a.sweep.empty() && a.sweep != "sa_max") {
    const std::string_view names[] = {"sa_max"};
    refuse("--sweep", fmt::format("unknown option '{}'{}", a.sweep, suggestion(a.sweep, names)));
  }
  if (!a.sweep.empty() && (a.inputs.empty() || !a.rows.empty())) refuse("--sweep", "it makes the rows: give no others");
  for (const std::string& row : rows_of(a.rows)) parse_pipeline(row);
  int to_output = 0;
  for (const std::string* path : {&a.json, &a.csv, &a.html, &a.save_rays}) {
    if (!path->empty() && *path != "-") check_output(*path);
    to_output += *path == "-" ? 1 : 0;
  }
  if (to_output > 1) refuse("-", "standard output can take one file only");
}

template <class Session>
int run_session(const StudyArguments& a, const std::string& command_line) {
  watch_interrupts();
  Session session(a);
  try {
    session.run();
  } catch (...) {
    if (session.has_results()) session.write(command_line);  // what is finished is not lost
    throw;
  }
  const bool is_complete = !interrupted();
  session.write(command_line);
  return is_complete ? kDone : kInterrupted;
}

int run_study(const StudyArguments& a, const std::string& command_line) {
  check_words(a);
  return a.is_splitting ? run_session<SplittingSession>(a, command_line) : run_session<StudySession>(a, command_line);
}

void add_options(CLI::App& command, StudyArguments& a) {
  command.add_option("inputs", a.inputs,
                     "YAML scenes or models; a model is seen from its row in a cameras.tsv beside it");
  command.add_option(
      "--rows", a.rows,
      fmt::format("Pipelines to compare, separated by commas, or all; see kerf list (default: {})", kStudyRows));
  command.add_option("--rays", a.rays,
                     fmt::format("Kinds of rays: primary, shadow, ambient_occlusion, diffuse (default: primary; with "
                                 "--splitting: {})",
                                 kSplittingRays));
  command.add_option("--size", a.size,
                     fmt::format("Width and height of the picture whose rays are traced (default: {}; with "
                                 "--splitting: {})",
                                 kStudySize, kSplittingSize));
  command.add_option("--turn", a.turn,
                     fmt::format("Turns the scene by 30 degrees about x, y, z or all three: xyz; with --splitting a "
                                 "list (default: {})",
                                 kSplittingTurns));
  command.add_flag(
      "--splitting", a.is_splitting,
      "What automatic splitting does to each scene, straight and turned: beside no splitting, a sweep of "
      "budgets, presets and splits inside the build; and which goals it reaches. A hundred thousand triangles "
      "take some minutes");
  command.add_flag("--no-determinism", a.no_determinism,
                   "With --splitting: do not build again with 1, 2 and 7 threads to compare the trees");
  command.add_flag("--paper", a.is_paper, "The table of Ernst and Greiner 2007: its scenes or stand-ins, and its rows");
  command.add_option("--seeds", a.seeds, "With --paper: how many plants (default: 1)")->check(CLI::Range(1, 100));
  command.add_option("--sweep", a.sweep, "sa_max: a row for each of a dozen surface area limits");
  command.add_option("--growth", a.growth, "A model of kerf make, from 1000 triangles on, ten times as many each time");
  command.add_option("--up-to", a.up_to, "With --growth: triangles of the largest (default: 1e6)")
      ->check(CLI::Range(1e3, 1e8));
  command.add_option("--save-rays", a.save_rays, "Write the rays to this file, a NumPy array");
  command.add_option("--load-rays", a.load_rays, "Trace the rays of this file, such as a NumPy array of shape (n, 6)");
  command.add_option("--threads", a.threads, "Threads that build; 0: all. Rays are always traced on one")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str();
  command
      .add_option("--repeat", a.repeat,
                  fmt::format("Timed runs of each row, in turn with the others (default: {}; with --splitting: {})",
                              kStudyRepeat, kSplittingRepeat))
      ->check(CLI::Range(1, 1000));
  command.add_option("--limit-seconds", a.limit_seconds, "Give up a row whose build or whose rays take longer")
      ->check(positive);
  command
      .add_option("--limit-gigabytes", a.limit_gigabytes,
                  "Give up a row that needs more memory; one that can do with less cuts less, and says so")
      ->check(positive)
      ->capture_default_str();
  command.add_flag("--no-overlap", a.no_overlap,
                   "Leave out the end-point overlap, which takes a while in large scenes");
  command.add_flag("--skip-invalid", a.skip_invalid, "Drop triangles that are not finite, instead of an error");
  command.add_option("--json", a.json, "Write figures to this file; '-' is standard output");
  command.add_option("--csv", a.csv, "Write a table to this file; '-' is standard output");
  command.add_option("--html", a.html, "Write a report to look at to this file");
  command.add_flag("--quiet", a.quiet, "No messages and no progress");
}

}  // namespace

void add_study(CLI::App& app, std::function<int()>& run) {
  CLI::App* command = app.add_subcommand(
      "study", "Builds structures over the same scene, shoots the same rays through them and compares what they cost.");
  command->footer(
      "Examples: kerf study hall.ply --rows 'binned_sah,early_split(auto)+binned_sah,kd_sah' --html hall.html\n"
      "          kerf study hall.ply --sweep sa_max --rays primary,diffuse --json curve.json\n"
      "          kerf study hall.ply --splitting --html splitting.html\n"
      "          kerf study --paper --html paper.html\n"
      "R: references per triangle; T_build: seconds; N_node, N_tri: nodes and triangle tests per ray; T_ray: seconds\n"
      "for all rays on one thread; S: how many times as fast as the first row that finished.");
  auto a = std::make_shared<StudyArguments>();
  add_options(*command, *a);
  add_camera_options(*command, *a);
  command->callback([a, &run] {
    std::string line = "kerf study";
    for (const std::string& input : a->inputs) line += " " + input;
    if (a->is_paper) line += " --paper";
    if (a->is_splitting) line += " --splitting";
    if (!a->rows.empty()) line += " --rows '" + a->rows + "'";
    if (!a->growth.empty()) line += fmt::format(" --growth {} --up-to {:g}", a->growth, a->up_to.value_or(kStudyUpTo));
    if (!a->sweep.empty()) line += " --sweep " + a->sweep;
    if (!a->rays.empty()) line += " --rays " + a->rays;
    if (!a->size.empty()) line += " --size " + a->size;
    if (!a->turn.empty()) line += " --turn " + a->turn;
    if (a->repeat) line += fmt::format(" --repeat {}", *a->repeat);
    run = [a, line] { return run_study(*a, line); };
  });
}

}  // namespace kerf::app
