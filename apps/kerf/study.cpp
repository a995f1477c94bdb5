// kerf study: structures side by side.

#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <vector>

#include "apps/kerf/command.h"
#include "apps/kerf/progress_bar.h"
#include "apps/kerf/scene_input.h"
#include "apps/kerf/study_output.h"
#include "kerf/base/error.h"
#include "kerf/base/nearest_word.h"
#include "kerf/scene/pipeline.h"
#include "kerf/study/camera_list.h"
#include "kerf/study/models/models.h"
#include "kerf/study/paper.h"
#include "kerf/study/tables.h"
#include "kerf/study/turn.h"

namespace kerf::app {
namespace {

constexpr const char* kDefaultRows =
    "binned_sah,early_split(budget=1.5)+binned_sah,early_split(budget=3)+binned_sah,kd_sah";

struct Arguments : SceneArguments {
  std::vector<std::string> inputs;
  std::string rows, rays = "primary", size = "1000x1000", turn = "straight", sweep, growth;
  std::string save_rays, load_rays, csv, html;
  bool is_paper = false, no_overlap = false;
  int repeat = 5, seeds = 1;
  double up_to = 1e6;
  double limit_seconds = std::numeric_limits<double>::infinity(), limit_gigabytes = 8;
};

std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find(',', begin), text.size());
    words.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return words;
}

std::vector<RayKind> parse_kinds(const std::string& text) {
  std::vector<RayKind> kinds;
  for (const std::string& word : words_of(text)) {
    std::vector<std::string_view> names;
    const RayKindEntry* found = nullptr;
    for (const RayKindEntry& entry : ray_kinds()) {
      names.push_back(entry.name);
      if (entry.name == word) found = &entry;
    }
    if (found == nullptr) {
      throw Error(ErrorCode::invalid_option, "--rays",
                  fmt::format("unknown kind '{}'{}", word, suggestion(word, names)));
    }
    if (std::find(kinds.begin(), kinds.end(), found->kind) == kinds.end()) kinds.push_back(found->kind);
  }
  return kinds;
}

/// Pipelines by name; "all" stands for everything in the menu.
std::vector<std::string> rows_of(const std::string& text) {
  if (text.empty()) return {};
  std::vector<std::string> rows;
  for (const std::string& row : split_pipeline_list(text)) {
    if (row == "all") {
      for (const std::string& one : all_rows()) rows.push_back(one);
    } else {
      rows.push_back(row);
    }
  }
  return rows;
}

std::vector<PaperStudyRow> plain_rows(const std::vector<std::string>& pipelines) {
  std::vector<PaperStudyRow> rows;
  for (const std::string& row : pipelines) rows.push_back({row, {}});
  return rows;
}

/// Mistakes in the words are found before any work is done.
void check_words(const Arguments& a) {
  const auto refuse = [](const char* option, const std::string& sentence) {
    throw Error(ErrorCode::invalid_option, option, sentence);
  };
  const bool has_own_scenes = a.is_paper || !a.growth.empty();
  if (has_own_scenes && !a.inputs.empty()) {
    refuse(a.is_paper ? "--paper" : "--growth", "it has scenes of its own: give no input");
  }
  if (!has_own_scenes && a.inputs.empty()) refuse("input", "give a scene or a model, --paper or --growth");
  if (a.is_paper && !a.growth.empty()) refuse("--growth", "it does not go with --paper");
  if (!a.growth.empty()) check_model_name(a.growth);
  if (!a.sweep.empty() && a.sweep != "sa_max") {
    const std::string_view names[] = {"sa_max"};
    refuse("--sweep", fmt::format("unknown option '{}'{}", a.sweep, suggestion(a.sweep, names)));
  }
  if (!a.sweep.empty() && (has_own_scenes || !a.rows.empty())) refuse("--sweep", "it makes the rows: give no others");
  if (!(a.save_rays.empty() && a.load_rays.empty()) && a.inputs.size() != 1) {
    refuse(a.save_rays.empty() ? "--load-rays" : "--save-rays", "rays belong to one scene: give one input");
  }
  turn_by_name(a.turn);
  parse_kinds(a.rays);
  parse_size(a.size);
  for (const std::string& row : rows_of(a.rows)) parse_pipeline(row);
  for (const std::string* path : {&a.json, &a.csv, &a.html, &a.save_rays}) {
    if (!path->empty() && *path != "-") check_output(*path);
  }
}

/// Reads one input; a model with a row in the cameras.tsv beside it is seen from there.
StudyScene read_scene_for(const Arguments& a, const std::string& input, double aspect) {
  SceneArguments one = a;
  one.input = input;
  StudyScene scene;
  scene.name = std::filesystem::path(input).stem().string();
  SceneInput read = read_input(one, aspect);
  scene.camera = read.camera;
  if (!a.eye && !a.look_at && !read.description.camera) {
    if (const std::optional<Camera> listed = listed_camera(input)) scene.camera = *listed;
  }
  scene.description = std::move(read.description);
  return scene;
}

/// A study of one or more scenes on the command line.
class Session {
 public:
  explicit Session(const Arguments& a) : a_(a), bar_(a.quiet) {
    const auto [width, height] = parse_size(a.size);
    options_.width = width;
    options_.height = height;
    options_.kinds = parse_kinds(a.rays);
    options_.threads = a.threads;
    options_.repeat = a.repeat;
    options_.limit_seconds = a.limit_seconds;
    options_.limit_bytes = static_cast<size_t>(a.limit_gigabytes * 1e9);
    options_.skip_invalid = a.skip_invalid;
    options_.with_overlap = !a.no_overlap;
    options_.cancelled = interrupt_flag();
    options_.progress = [this](double done, std::string_view what) {
      return bar_((static_cast<double>(scene_) + done) / static_cast<double>(scenes_), what);
    };
  }

  double aspect() const { return static_cast<double>(options_.width) / options_.height; }
  void expect(size_t scenes) { scenes_ = std::max<size_t>(scenes, 1); }

  /// Studies a scene and keeps what comes out. `paper` has the paper's figures for some rows.
  void add(StudyScene scene, const std::vector<PaperStudyRow>& rows) {
    if (interrupted()) return;
    if (a_.turn != "straight") {
      const Transform turn = turn_by_name(a_.turn);
      scene = {scene.name + " turned " + a_.turn, turned(std::move(scene.description), turn),
               turned(scene.camera, turn)};
    }
    options_.rows.clear();
    for (const PaperStudyRow& row : rows) options_.rows.push_back(row.pipeline);
    load_or_save(scene);
    for (StudyResult& result : study(scene, options_)) {
      for (const PaperStudyRow& row : rows) {
        if (row.paper && parse_pipeline(row.pipeline).text() == result.row && result.rays == "primary") {
          result.paper = row.paper;
        }
      }
      results.push_back(std::move(result));
    }
    ++scene_;
  }

  std::vector<StudyResult> results;
  std::vector<std::string> notes;

 private:
  void load_or_save(const StudyScene& scene) {
    if (!a_.load_rays.empty()) {
      rays_ = load_rays(a_.load_rays);
    } else if (!a_.save_rays.empty()) {
      rays_ = make_study_rays(scene.description, scene.camera, options_.width, options_.height, options_.kinds,
                              a_.skip_invalid);
      kerf::save_rays(a_.save_rays, rays_);
    }
    options_.loaded = rays_;
  }

  const Arguments& a_;
  ProgressBar bar_;
  StudyOptions options_;
  std::vector<StudyRays> rays_;
  size_t scene_ = 0, scenes_ = 1;
};

void study_paper(const Arguments& a, Session& session) {
  std::vector<std::string> folders{"scenes/real"};
  if (const char* given = std::getenv("KERF_SCENES"); given != nullptr && *given != '\0') {
    folders.insert(folders.begin(), given);
  }
  const std::vector<PaperStandIn> stand_ins = paper_stand_ins(folders, a.seeds, session.notes);
  session.expect(stand_ins.size());
  for (const PaperStandIn& stand_in : stand_ins) {
    if (interrupted()) break;
    StudyScene scene = stand_in.load();
    std::vector<PaperStudyRow> rows = paper_rows(scene.description, *stand_in.paper);
    for (const PaperStudyRow& row : plain_rows(rows_of(a.rows))) rows.push_back(row);
    session.add(std::move(scene), rows);
  }
}

void study_inputs(const Arguments& a, Session& session) {
  session.expect(a.inputs.size());
  for (const std::string& input : a.inputs) {
    if (interrupted()) break;
    StudyScene scene = read_scene_for(a, input, session.aspect());
    const std::vector<std::string> rows =
        !a.sweep.empty() ? sweep_rows(scene.description) : rows_of(a.rows.empty() ? kDefaultRows : a.rows);
    session.add(std::move(scene), plain_rows(rows));
  }
}

/// One family of models, each ten times as large as the one before.
void study_growth(const Arguments& a, Session& session) {
  std::vector<uint64_t> sizes;
  for (double size = 1000; size <= a.up_to * 1.0001; size *= 10) sizes.push_back(static_cast<uint64_t>(size));
  session.expect(sizes.size());
  for (const uint64_t size : sizes) {
    if (interrupted()) break;
    session.add(made_scene(fmt::format("{} {}", a.growth, size), a.growth, size, 1),
                plain_rows(rows_of(a.rows.empty() ? "all" : a.rows)));
  }
}

void write(const Arguments& a, Session& session, const std::string& command_line) {
  ignore_interrupts();
  const auto& results = session.results;
  if (!a.json.empty()) write_json(a.json, study_json(results));
  if (!a.csv.empty()) write_text(a.csv, csv_table(results));
  if (!a.html.empty()) {
    StudyReport report;
    report.title = a.is_paper ? "The table of the paper" : "Structures side by side";
    report.command = command_line;
    report.machine = machine_line();
    report.notes = session.notes;
    (!a.sweep.empty() ? report.sweep : !a.growth.empty() ? report.growth : report.results) = results;
    write_text(a.html, html_report(report));
  }
  const bool is_taken = a.json == "-" || a.csv == "-" || a.html == "-";
  if (!is_taken) fmt::print("{}", text_tables(results));
  if (a.quiet) return;
  for (const std::string& note : session.notes) fmt::print(stderr, "kerf: note: {}\n", note);
}

int run_study(const Arguments& a, const std::string& command_line) {
  check_words(a);
  watch_interrupts();
  Session session(a);
  if (a.is_paper) {
    study_paper(a, session);
  } else if (!a.growth.empty()) {
    study_growth(a, session);
  } else {
    study_inputs(a, session);
  }
  const bool is_complete = !interrupted();
  write(a, session, command_line);
  return is_complete ? kDone : kInterrupted;
}

void add_options(CLI::App& command, Arguments& a) {
  command.add_option("inputs", a.inputs,
                     "YAML scenes or models; a model is seen from its row in a cameras.tsv beside it");
  command.add_option(
      "--rows", a.rows,
      fmt::format("Pipelines to compare, separated by commas, or all; see kerf list (default: {})", kDefaultRows));
  command.add_option("--rays", a.rays, "Kinds of rays: primary, shadow, ambient_occlusion, diffuse")
      ->capture_default_str();
  command.add_option("--size", a.size, "Width and height of the picture whose rays are traced")->capture_default_str();
  command.add_option("--turn", a.turn, "Turns the scene by 30 degrees about x, y, z or all three: xyz")
      ->capture_default_str();
  command.add_flag("--paper", a.is_paper, "The table of Ernst and Greiner 2007: its scenes or stand-ins, and its rows");
  command.add_option("--seeds", a.seeds, "With --paper: how many plants")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command.add_option("--sweep", a.sweep, "sa_max: a row for each of a dozen surface area limits");
  command.add_option("--growth", a.growth, "A model of kerf make, from 1000 triangles on, ten times as many each time");
  command.add_option("--up-to", a.up_to, "With --growth: triangles of the largest")
      ->check(CLI::Range(1e3, 1e8))
      ->capture_default_str();
  command.add_option("--save-rays", a.save_rays, "Write the rays to this file, a NumPy array");
  command.add_option("--load-rays", a.load_rays, "Trace the rays of this file, such as a NumPy array of shape (n, 6)");
  command.add_option("--threads", a.threads, "Threads that build; 0: all. Rays are always traced on one")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str();
  command.add_option("--repeat", a.repeat, "Timed runs of each row, in turn with the others")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command.add_option("--limit-seconds", a.limit_seconds, "Give up a row whose build or whose rays take longer")
      ->check(CLI::PositiveNumber);
  command.add_option("--limit-gigabytes", a.limit_gigabytes, "Give up a row that needs more memory")
      ->check(CLI::PositiveNumber)
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
      "Examples: kerf study hall.ply --rows 'binned_sah,early_split(budget=1.5)+binned_sah,kd_sah' --html hall.html\n"
      "          kerf study hall.ply --sweep sa_max --rays primary,diffuse --json curve.json\n"
      "          kerf study --paper --html paper.html\n"
      "R: references per triangle; T_build: seconds; N_node, N_tri: nodes and triangle tests per ray; T_ray: seconds\n"
      "for all rays on one thread; S: how many times as fast as the first row.");
  auto a = std::make_shared<Arguments>();
  add_options(*command, *a);
  add_camera_options(*command, *a);
  command->callback([a, &run] {
    std::string line = "kerf study";
    for (const std::string& input : a->inputs) line += " " + input;
    if (a->is_paper) line += " --paper";
    if (!a->rows.empty()) line += " --rows '" + a->rows + "'";
    if (!a->growth.empty()) line += fmt::format(" --growth {} --up-to {:g}", a->growth, a->up_to);
    if (!a->sweep.empty()) line += " --sweep " + a->sweep;
    line += " --rays " + a->rays + " --size " + a->size;
    if (a->turn != "straight") line += " --turn " + a->turn;
    run = [a, line] { return run_study(*a, line); };
  });
}

}  // namespace kerf::app
