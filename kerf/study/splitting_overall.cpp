// What comes of the goals over all scenes together.

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <optional>

#include "kerf/study/splitting_goals.h"
#include "kerf/study/spread.h"

namespace kerf {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// A bar on the geometric mean over scenes.
struct MeanBar {
  std::string_view id;
  double bar;
  bool is_least;         ///< at least, else at most
  bool is_all_there_is;  ///< no single scene is held to anything
};
constexpr MeanBar kMeanBars[] = {
    {"sbvh_speed", 0.95, true, false}, {"best", 0.85, false, true}, {"reinsertion", 0.9, false, true}};

/// The verdicts on one goal, scene by scene.
struct Column {
  std::vector<const GoalVerdict*> verdicts;
  std::span<const SplittingScene> scenes;

  size_t count(GoalState state) const {
    size_t count = 0;
    for (const GoalVerdict* verdict : verdicts) count += verdict->state == state ? 1 : 0;
    return count;
  }
};

/// "; worst: sponza turned x: ...", or nothing.
std::string worst_text(const Column& column) {
  const GoalVerdict* worst = nullptr;
  size_t scene = 0;
  for (size_t i = 0; i < column.verdicts.size(); ++i) {
    const GoalVerdict* verdict = column.verdicts[i];
    // Of goals without a number only misses are worth a word.
    const bool is_judged =
        verdict->state == GoalState::missed || (verdict->state == GoalState::reached && !std::isnan(verdict->measured));
    if (!is_judged || (worst != nullptr && !(verdict->slack < worst->slack))) continue;
    worst = verdict;
    scene = i;
  }
  return worst == nullptr ? "" : fmt::format("; worst: {}: {}", column.scenes[scene].title(), worst->text);
}

GoalVerdict over_scenes(const SplittingGoal& goal, const Column& column) {
  const size_t reached = column.count(GoalState::reached), missed = column.count(GoalState::missed);
  const size_t unknown = column.count(GoalState::not_measured);
  GoalVerdict verdict{&goal, GoalState::not_asked, kUnknown, kUnknown, "asked of no scene here"};
  if (reached + missed + unknown == 0) return verdict;
  verdict.state = missed > 0 ? GoalState::missed : unknown > 0 ? GoalState::not_measured : GoalState::reached;
  verdict.text = fmt::format("reached on {} of {} scenes", reached, reached + missed + unknown);
  if (unknown > 0) verdict.text += fmt::format(", not measured on {}", unknown);
  verdict.text += worst_text(column);
  for (size_t i = 0; reached + missed == 0 && i < column.verdicts.size(); ++i) {
    if (column.verdicts[i]->state != GoalState::not_measured) continue;
    verdict.text += ": " + column.verdicts[i]->text;
    break;
  }
  return verdict;
}

/// Also holds the mean to its bar.
void judge_mean(GoalVerdict& verdict, const MeanBar& bar, const Column& column) {
  std::vector<double> values;
  for (const GoalVerdict* one : column.verdicts) {
    if (!std::isnan(one->measured)) values.push_back(one->measured);
  }
  if (values.empty()) return;
  const double mean = geometric_mean(values);
  verdict.measured = mean;
  verdict.slack = (bar.is_least ? mean - bar.bar : bar.bar - mean) / bar.bar;
  const std::string text = fmt::format("mean {:.3f} of {} scenes", mean, values.size());
  verdict.text = bar.is_all_there_is ? text : text + "; " + verdict.text;
  const bool is_complete = values.size() == column.verdicts.size();
  if (!(verdict.slack >= 0)) {
    verdict.state = GoalState::missed;
  } else if (bar.is_all_there_is) {
    verdict.state = is_complete ? GoalState::reached : GoalState::not_measured;
    if (!is_complete) verdict.text += fmt::format(", {} not measured", column.verdicts.size() - values.size());
  }
}

}  // namespace

std::vector<GoalVerdict> overall_verdicts(std::span<const SplittingScene> scenes) {
  std::vector<std::vector<GoalVerdict>> all;
  for (const SplittingScene& scene : scenes) all.push_back(scene_verdicts(scene));
  std::vector<GoalVerdict> overall;
  for (size_t i = 0; i < splitting_goals().size(); ++i) {
    const SplittingGoal& goal = splitting_goals()[i];
    Column column{{}, scenes};
    for (const auto& verdicts : all) column.verdicts.push_back(&verdicts[i]);
    overall.push_back(over_scenes(goal, column));
    for (const MeanBar& bar : kMeanBars) {
      if (bar.id == goal.id) judge_mean(overall.back(), bar, column);
    }
  }
  return overall;
}

}  // namespace kerf
