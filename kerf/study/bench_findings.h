#pragma once

#include <functional>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kerf/study/bench_result.h"
#include "kerf/study/splitting_goals.h"
#include "kerf/study/spread.h"

namespace kerf {

/// A figure that is not known.
inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// A verdict without its goal.
struct BenchFinding {
  GoalState state = GoalState::not_measured;
  double measured = kUnknown;
  std::string text;
};

inline BenchFinding not_measured(std::string why) { return {GoalState::not_measured, kUnknown, std::move(why)}; }
inline GoalState reached_if(bool is_reached) { return is_reached ? GoalState::reached : GoalState::missed; }

/// One figure, scene by scene.
struct BenchColumn {
  std::vector<double> values;  ///< of those where it is known
  size_t scenes = 0;
  double least = kUnknown, most = kUnknown;
  std::string least_scene, most_scene;

  double mean() const { return geometric_mean(values); }
  size_t missing() const { return scenes - values.size(); }
};

BenchColumn column_of(std::span<const BenchScene> scenes, const std::function<double(const BenchScene&)>& value_of);

/// What a column comes to: reached only where it is known on every scene.
BenchFinding with_all(const BenchColumn& column, double measured, bool is_reached, const std::string& text);
BenchFinding mean_at_least(const BenchColumn& column, double bar, const std::string& what);
/// Strict: less than the bar.
BenchFinding mean_at_most(const BenchColumn& column, double bar, const std::string& what, bool is_strict = false);

/// The worst of several findings, at least one, that must all be reached.
BenchFinding all_of(const std::vector<BenchFinding>& findings);

}  // namespace kerf
