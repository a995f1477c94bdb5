#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kerf/study/bench_result.h"
#include "kerf/study/splitting_goals.h"

namespace kerf {

/// What Kerf beside Embree is held to.
struct BenchGoal {
  std::string_view id;
  std::string_view name;  ///< a few words
  std::string_view bar;   ///< a sentence
};

/// All of them, in the order in which verdicts come.
std::span<const BenchGoal> bench_goals();

/// What came of one goal.
struct BenchVerdict {
  const BenchGoal* goal = nullptr;
  GoalState state = GoalState::not_measured;
  double measured = 0;  ///< in the bar's own measure; NaN where it is not known
  std::string text;     ///< what was measured, or why it was not
};

/// One verdict for each goal over all scenes, those measured with one thread unless the goal is about more. Ratios are
/// geometric means over scenes; what is not known on every scene is not reached. Rays are judged by one row of Kerf's
/// for all scenes and kinds: of preset `best` where there is one, the one whose mean is greatest.
std::vector<BenchVerdict> bench_verdicts(std::span<const BenchScene> scenes);

}  // namespace kerf
