#include "apps/kerf/study_session.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "apps/kerf/command.h"
#include "apps/kerf/study_output.h"
#include "kerf/base/error.h"
#include "kerf/base/nearest_word.h"
#include "kerf/scene/pipeline.h"
#include "kerf/study/study_pictures.h"
#include "kerf/study/tables.h"
#include "kerf/study/turn.h"

namespace kerf::app {
namespace {

std::vector<PaperStudyRow> plain_rows(const std::vector<std::string>& pipelines) {
  std::vector<PaperStudyRow> rows;
  rows.reserve(pipelines.size());
  for (const std::string& row : pipelines) rows.push_back({row, {}});
  return rows;
}

}  // namespace

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

std::vector<std::string> parse_turns(const std::string& text) {
  std::vector<std::string> turns;
  for (const std::string& word : words_of(text)) {
    turn_by_name(word);
    if (std::find(turns.begin(), turns.end(), word) == turns.end()) turns.push_back(word);
  }
  return turns;
}

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

MeasureOptions measure_options(const StudyArguments& a) {
  MeasureOptions options;
  options.threads = a.threads;
  options.limit_seconds = a.limit_seconds;
  const double bytes = a.limit_gigabytes * 1e9;
  if (bytes < 1e18) options.limit_bytes = static_cast<size_t>(bytes);  // else none
  options.skip_invalid = a.skip_invalid;
  options.cancelled = interrupt_flag();
  return options;
}

StudyScene read_study_scene(const StudyArguments& a, const std::string& input, double aspect) {
  SceneArguments one = a;
  one.input = input;
  SceneInput scene = read_input(one, aspect);
  return {std::filesystem::path(input).stem().string(), std::move(scene.description), scene.camera};
}

StudyScene turned_scene(StudyScene scene, const std::string& turn) {
  if (turn.empty() || turn == "straight") return scene;
  const Transform transform = turn_by_name(turn);
  return {scene.name + " turned " + turn, turned(std::move(scene.description), transform),
          turned(scene.camera, transform)};
}

StudySession::StudySession(const StudyArguments& a) : a_(a), bar_(a.quiet) {
  const auto [width, height] = parse_size(a.size.empty() ? kStudySize : a.size);
  options_.width = width;
  options_.height = height;
  options_.kinds = parse_kinds(a.rays.empty() ? "primary" : a.rays);
  options_.repeat = a.repeat.value_or(kStudyRepeat);
  static_cast<MeasureOptions&>(options_) = measure_options(a);
  options_.with_overlap = !a.no_overlap;
  options_.progress = [this](double done, std::string_view what) {
    return bar_((static_cast<double>(scene_) + done) / static_cast<double>(scenes_), what);
  };
}

void StudySession::run() {
  if (a_.is_paper) {
    study_paper();
  } else if (!a_.growth.empty()) {
    study_growth();
  } else {
    study_inputs();
  }
}

/// Keeps what comes out; `rows` have the paper's figures where it has some.
void StudySession::add(const StudyScene& scene, const std::vector<PaperStudyRow>& rows) {
  if (interrupted()) return;
  options_.rows.clear();
  for (const PaperStudyRow& row : rows) options_.rows.push_back(row.pipeline);
  load_or_save(scene);
  std::vector<StudyResult> found = study(scene, options_);
  if (!a_.html.empty() && a_.growth.empty() && !interrupted()) {
    for (ReportPicture& picture : study_pictures(scene, found, options_)) pictures_.push_back(std::move(picture));
  }
  for (StudyResult& result : found) {
    for (const PaperStudyRow& row : rows) {
      if (row.paper && parse_pipeline(row.pipeline).text() == result.row && result.rays == "primary") {
        result.paper = row.paper;
      }
    }
    results_.push_back(std::move(result));
  }
  ++scene_;
}

void StudySession::load_or_save(const StudyScene& scene) {
  if (!a_.load_rays.empty()) {
    rays_ = load_rays(a_.load_rays);
  } else if (!a_.save_rays.empty()) {
    WorkLimit limit;
    limit.cancelled = interrupt_flag();
    rays_ = make_study_rays(scene.description, scene.camera, options_.width, options_.height, options_.kinds,
                            a_.skip_invalid, limit);
    save_rays(a_.save_rays, rays_);
  }
  options_.loaded = rays_;
}

void StudySession::study_paper() {
  std::vector<std::string> folders{"scenes/real"};
  if (const char* given = std::getenv("KERF_SCENES"); given != nullptr && *given != '\0') {
    folders.insert(folders.begin(), given);
  }
  const std::vector<PaperStandIn> stand_ins = paper_stand_ins(folders, a_.seeds.value_or(1), notes_);
  scenes_ = stand_ins.size();
  for (const PaperStandIn& stand_in : stand_ins) {
    if (interrupted()) break;
    const StudyScene scene = stand_in.load();
    std::vector<PaperStudyRow> rows = paper_rows(scene.description, *stand_in.paper);
    for (const PaperStudyRow& row : plain_rows(rows_of(a_.rows))) rows.push_back(row);
    const size_t before = results_.size();
    add(scene, rows);
    if (!stand_in.is_made_plant) continue;
    const std::string verdict = stand_in_verdict(*stand_in.paper, std::span(results_).subspan(before));
    if (!verdict.empty()) notes_.push_back(verdict);
  }
}

void StudySession::study_inputs() {
  scenes_ = a_.inputs.size();
  for (const std::string& input : a_.inputs) {
    if (interrupted()) break;
    const StudyScene scene =
        turned_scene(read_study_scene(a_, input, static_cast<double>(options_.width) / options_.height), a_.turn);
    add(scene, plain_rows(!a_.sweep.empty() ? sweep_rows(scene.description)
                                            : rows_of(a_.rows.empty() ? kStudyRows : a_.rows)));
  }
}

/// One family of models, each ten times as large as the one before.
void StudySession::study_growth() {
  std::vector<uint64_t> sizes;
  for (double size = 1000; size <= a_.up_to.value_or(kStudyUpTo) * 1.0001; size *= 10) {
    sizes.push_back(static_cast<uint64_t>(size));
  }
  scenes_ = sizes.size();
  for (const uint64_t size : sizes) {
    if (interrupted()) break;
    const StudyScene scene = made_scene(fmt::format("{} {}", a_.growth, size), a_.growth, size, 1);
    add(turned_scene(scene, a_.turn), plain_rows(rows_of(a_.rows.empty() ? "all" : a_.rows)));
  }
}

/// Standard output is for a file's content, so no table is printed there.
bool StudySession::is_taken() const { return a_.json == "-" || a_.csv == "-" || a_.html == "-"; }

void StudySession::write(const std::string& command_line) {
  ignore_interrupts();
  if (!a_.json.empty()) write_json(a_.json, study_json(results_));
  if (!a_.csv.empty()) write_text(a_.csv, csv_table(results_));
  if (!a_.html.empty()) {
    StudyReport report;
    report.title = a_.is_paper ? "The table of the paper" : "Structures side by side";
    report.command = command_line;
    report.machine = machine_line();
    report.notes = notes_;
    report.pictures = std::move(pictures_);
    (!a_.sweep.empty() ? report.sweep : !a_.growth.empty() ? report.growth : report.results) = results_;
    write_text(a_.html, html_report(report));
  }
  if (!is_taken()) fmt::print("{}", text_tables(results_));
  if (a_.quiet) return;
  for (const std::string& note : notes_) fmt::print(stderr, "kerf: note: {}\n", note);
}

std::string positive(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  return *end == '\0' && value > 0 ? "" : "it must be a number above 0, or inf";
}

}  // namespace kerf::app
