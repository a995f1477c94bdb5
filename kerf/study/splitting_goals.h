#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kerf/study/splitting_result.h"

namespace kerf {

/// What splitting is held to.
struct SplittingGoal {
  std::string_view id;    ///< in JSON
  std::string_view name;  ///< a few words
  std::string_view bar;   ///< a sentence, with how it is measured
};

/// All of them, in the order in which verdicts come.
std::span<const SplittingGoal> splitting_goals();

enum class GoalState { reached, missed, not_measured, not_asked };

std::string_view state_name(GoalState state);  ///< "reached", "missed", "not measured", "not asked"

/// What came of one goal.
struct GoalVerdict {
  const SplittingGoal* goal = nullptr;
  GoalState state = GoalState::not_measured;
  double measured = 0;  ///< in the bar's own measure; NaN where it has none
  double slack = 0;     ///< how far it lies on the good side of the bar, as a share of it; NaN where unknown
  std::string text;     ///< what was measured, or why it was not
};

/// One verdict for each goal on one scene. What is not known is not measured, never reached.
std::vector<GoalVerdict> scene_verdicts(const SplittingScene& scene);

/// One verdict for each goal over all scenes: averages where the bar is one, else reached only where every scene that
/// it asks for reaches it, with how many do and the worst.
std::vector<GoalVerdict> overall_verdicts(std::span<const SplittingScene> scenes);

}  // namespace kerf
