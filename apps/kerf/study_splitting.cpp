#include "apps/kerf/study_splitting.h"

#include <fmt/core.h>

#include <algorithm>

#include "apps/kerf/command.h"
#include "apps/kerf/study_output.h"
#include "kerf/base/error.h"
#include "kerf/study/splitting_report.h"
#include "kerf/study/splitting_tables.h"

namespace kerf::app {
void check_splitting(const StudyArguments& a) {
  const auto refuse = [](const char* option, const char* sentence) {
    throw Error(ErrorCode::invalid_option, option, sentence);
  };
  if (a.inputs.empty()) refuse("--splitting", "give a scene or a model");
  if (!a.rows.empty()) refuse("--rows", "--splitting has rows of its own");
  if (!a.sweep.empty()) refuse("--sweep", "--splitting has a sweep of its own, of budgets");
  if (!(a.save_rays.empty() && a.load_rays.empty())) {
    refuse(a.save_rays.empty() ? "--load-rays" : "--save-rays", "it does not go with --splitting");
  }
  if (a.no_overlap) refuse("--no-overlap", "--splitting measures no overlap");
  parse_turns(a.turn.empty() ? kSplittingTurns : a.turn);
}

SplittingSession::SplittingSession(const StudyArguments& a)
    : a_(a), bar_(a.quiet), turns_(parse_turns(a.turn.empty() ? kSplittingTurns : a.turn)) {
  const auto [width, height] = parse_size(a.size.empty() ? kSplittingSize : a.size);
  options_.width = width;
  options_.height = height;
  options_.kinds = parse_kinds(a.rays.empty() ? kSplittingRays : a.rays);
  options_.repeat = a.repeat.value_or(kSplittingRepeat);
  static_cast<MeasureOptions&>(options_) = measure_options(a);
  options_.with_threads = !a.no_determinism;
  options_.progress = [this](double done, std::string_view what) {
    const auto steps = static_cast<double>(a_.inputs.size() * turns_.size());
    return bar_((static_cast<double>(step_) + done) / steps, what);
  };
}

void SplittingSession::run() {
  for (const std::string& input : a_.inputs) {
    if (interrupted()) return;
    const StudyScene scene = read_study_scene(a_, input, static_cast<double>(options_.width) / options_.height);
    for (const std::string& turn : turns_) {
      if (interrupted()) return;
      const StudyScene turned = turned_scene(scene, turn);
      scenes_.push_back(study_splitting({scene.name, turned.description, turned.camera}, turn, options_));
      const std::vector<SplittingRow>& rows = scenes_.back().rows;
      if (std::none_of(rows.begin(), rows.end(), [](const auto& row) { return row.finished; }) && interrupted()) {
        scenes_.pop_back();  // nothing was finished
      }
      ++step_;
    }
  }
}

void SplittingSession::write(const std::string& command_line) {
  ignore_interrupts();
  if (!a_.json.empty()) write_json(a_.json, splitting_json(scenes_));
  if (!a_.csv.empty()) write_text(a_.csv, splitting_csv(scenes_));
  if (!a_.html.empty()) {
    write_text(a_.html, splitting_report({"What splitting does", command_line, machine_line(), scenes_}));
  }
  if (a_.json != "-" && a_.csv != "-" && a_.html != "-") fmt::print("{}", splitting_text(scenes_));
}

}  // namespace kerf::app
