#pragma once

#include <span>
#include <string>

#include "kerf/study/report/markup.h"
#include "kerf/study/splitting_goals.h"

namespace kerf::report {

/// Goal, what came of it, what was measured, the bar: a line each.
void write_goals(Markup& out, std::span<const GoalVerdict> verdicts, std::string_view caption);

/// What came of each goal on each scene: scenes down, goals across.
void write_goal_matrix(Markup& out, std::span<const SplittingScene> scenes);

/// The rows of one scene with their figures.
void write_splitting_rows(Markup& out, const SplittingScene& scene);

}  // namespace kerf::report
