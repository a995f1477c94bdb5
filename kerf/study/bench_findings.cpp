#include "kerf/study/bench_findings.h"

#include <fmt/format.h>

#include <cmath>

namespace kerf {

BenchColumn column_of(std::span<const BenchScene> scenes, const std::function<double(const BenchScene&)>& value_of) {
  BenchColumn column;
  for (const BenchScene& scene : scenes) {
    const double value = value_of(scene);
    ++column.scenes;
    if (std::isnan(value)) continue;
    column.values.push_back(value);
    if (!(column.least <= value)) {
      column.least = value;
      column.least_scene = scene.title();
    }
    if (!(column.most >= value)) {
      column.most = value;
      column.most_scene = scene.title();
    }
  }
  return column;
}

BenchFinding with_all(const BenchColumn& column, double measured, bool is_reached, const std::string& text) {
  if (column.values.empty())
    return not_measured(column.scenes == 0 ? "there is no scene with one thread" : "it is not known on any scene");
  BenchFinding finding{reached_if(is_reached), measured, text};
  if (column.missing() > 0) {
    finding.text += fmt::format("; not known on {} of {} scenes", column.missing(), column.scenes);
    if (is_reached) finding.state = GoalState::not_measured;
  }
  return finding;
}

BenchFinding mean_at_least(const BenchColumn& column, double bar, const std::string& what) {
  return with_all(
      column, column.mean(), column.mean() >= bar,
      fmt::format("{:.3f}x ({}); least {:.3f}x ({})", column.mean(), what, column.least, column.least_scene));
}

BenchFinding mean_at_most(const BenchColumn& column, double bar, const std::string& what, bool is_strict) {
  const double mean = column.mean();
  return with_all(column, mean, is_strict ? mean < bar : mean <= bar,
                  fmt::format("{:.3f} ({}); most {:.3f} ({})", mean, what, column.most, column.most_scene));
}

BenchFinding all_of(const std::vector<BenchFinding>& findings) {
  const auto rank = [](const BenchFinding& f) {
    return f.state == GoalState::missed ? 0 : f.state == GoalState::reached ? 2 : 1;
  };
  BenchFinding out = findings.front();
  out.text.clear();
  for (const BenchFinding& finding : findings) {
    if (rank(finding) < rank(out)) out = {finding.state, finding.measured, out.text};
    if (out.text.find(finding.text) == std::string::npos) out.text += (out.text.empty() ? "" : "; ") + finding.text;
  }
  return out;
}

}  // namespace kerf
