#include "kerf/study/report/splitting_sections.h"

#include <fmt/format.h>

#include <cmath>

#include "kerf/study/report/number_text.h"
#include "kerf/study/report/row_style.h"
#include "kerf/study/splitting_tables.h"
#include "kerf/study/spread.h"

namespace kerf::report {
namespace {

std::string_view state_class(GoalState state) {
  constexpr std::string_view kClasses[] = {"state up2", "state missed", "state none", "state none"};
  return kClasses[static_cast<size_t>(state)];
}

void begin_table(Markup& out, std::string_view kind, std::string_view caption) {
  out.open("div", {{"class", "scroll"}, {"tabindex", "0"}, {"role", "region"}, {"aria-label", caption}});
  out.open("table", {{"class", kind}});
  out.element("caption", caption);
  out.open("thead");
  out.open("tr");
}

void write_head(Markup& out, std::string_view name, std::string_view words, std::string_view title = {}) {
  if (title.empty()) {
    out.open("th", {{"scope", "col"}});
  } else {
    out.open("th", {{"scope", "col"}, {"title", title}});
  }
  out.element("span", name);
  if (!words.empty()) out.element("span", {{"class", "words"}}, words);
  out.close();
}

void begin_body(Markup& out) {
  out.close();
  out.close();
  out.open("tbody");
  out.line();
}

void end_table(Markup& out) {
  out.close();
  out.close();
  out.close();
  out.line();
}

void write_cell(Markup& out, double value, const std::string& text, std::string_view range = {}) {
  out.open("td", {{"data-v", script_number(value)}});
  out.element("span", std::isnan(value) ? "\xE2\x80\x93" : text);
  if (!range.empty()) out.element("span", {{"class", "range"}}, range);
  out.close();
}

/// A speed with its interval.
void write_speed(Markup& out, const std::vector<double>& speeds) {
  const double median = median_of(speeds);
  const std::optional<Interval> interval = median_interval(speeds);
  write_cell(out, median, number_text(median) + "\xC3\x97",
             interval ? fmt::format("{} to {}", number_text(interval->lower), number_text(interval->upper)) : "");
}

double median_seconds(const SplittingRow& row, double BuildReport::Seconds::*part) {
  std::vector<double> seconds;
  for (const BuildReport::Seconds& build : row.builds) seconds.push_back(build.*part);
  return median_of(std::move(seconds));
}

void write_figures(Markup& out, const SplittingScene& scene, const SplittingRow& row) {
  const double split = median_seconds(row, &BuildReport::Seconds::split);
  const double build = median_seconds(row, &BuildReport::Seconds::total);
  write_cell(out, row.references_per_primitive, fmt::format("{:.3f}", row.references_per_primitive));
  write_cell(out, split, seconds_text(split));
  write_cell(out, build, seconds_text(build));
  write_cell(out, static_cast<double>(row.bytes), report::bytes_text(static_cast<double>(row.bytes)));
  write_cell(out, row.sah_cost, number_text(row.sah_cost));
  for (size_t k = 0; k < row.rays.size(); ++k) {
    const double share = visits_share(scene, row, k);
    write_cell(out, share, fmt::format("{:.3f}", share),
               fmt::format("{} + {}", number_text(row.rays[k].nodes), number_text(row.rays[k].triangles)));
  }
  const double all = visits_share(scene, row);
  write_cell(out, all, fmt::format("{:.3f}", all));
  const SplittingRow* plain = scene.row(SplittingRole::plain);
  write_speed(out, plain != nullptr ? paired_speeds(scene, *plain, row) : std::vector<double>());
}

}  // namespace

void write_goals(Markup& out, std::span<const GoalVerdict> verdicts, std::string_view caption) {
  begin_table(out, "goals", caption);
  write_head(out, "Goal", "");
  write_head(out, "State", "");
  write_head(out, "Measured", "");
  write_head(out, "Bar", "");
  begin_body(out);
  for (const GoalVerdict& verdict : verdicts) {
    out.open("tr");
    out.element("th", {{"scope", "row"}}, verdict.goal->name);
    out.element("td", {{"class", state_class(verdict.state)}}, state_name(verdict.state));
    out.element("td", {{"class", "said"}}, verdict.text);
    out.element("td", {{"class", "said bar-text"}}, verdict.goal->bar);
    out.close();
    out.line();
  }
  end_table(out);
}

void write_goal_matrix(Markup& out, std::span<const SplittingScene> scenes) {
  begin_table(out, "goals matrix", "What came of each goal on each scene");
  write_head(out, "Scene", "");
  for (const SplittingGoal& goal : splitting_goals()) write_head(out, goal.name, "", goal.bar);
  begin_body(out);
  for (const SplittingScene& scene : scenes) {
    out.open("tr");
    out.element("th", {{"scope", "row"}}, scene.title());
    for (const GoalVerdict& verdict : scene_verdicts(scene)) {
      constexpr std::string_view kMarks[] = {"yes", "NO", "?", ""};
      const std::string_view mark = kMarks[static_cast<size_t>(verdict.state)];
      const std::string number = std::isnan(verdict.measured) ? "" : number_text(verdict.measured);
      out.open("td", {{"class", state_class(verdict.state)},
                      {"data-v", script_number(verdict.measured)},
                      {"title", fmt::format("{}: {}", state_name(verdict.state), verdict.text)}});
      if (!mark.empty()) out.element("span", mark);
      if (!number.empty()) out.element("span", {{"class", "range"}}, number);
      out.close();
    }
    out.close();
    out.line();
  }
  end_table(out);
}

void write_splitting_rows(Markup& out, const SplittingScene& scene) {
  begin_table(out, "results", scene.title() + ": rows");
  write_head(out, "Row", "");
  for (const auto& [name, words] : {std::pair("R", "references"),
                                    {"T split", "cut, choose"},
                                    {"T build", "in all"},
                                    {"bytes", ""},
                                    {"SAH", "cost"}}) {
    write_head(out, name, words);
  }
  for (const std::string& kind : scene.kinds) write_head(out, kind, "visits of plain's; nodes + triangles");
  write_head(out, "all kinds", "visits of plain's");
  write_head(out, "ray speed", "all kinds; 95 % interval");
  begin_body(out);
  for (const SplittingRow& row : scene.rows) {
    out.open("tr");
    out.open("th", {{"scope", "row"}, {"title", row.pipeline}});
    out.text(row_name(row));
    out.close();
    if (row.finished) {
      write_figures(out, scene, row);
    } else {
      out.open("td", {{"class", "unfinished"}, {"colspan", std::to_string(7 + scene.kinds.size())}});
      out.element("b", "not finished");
      out.text(": " + row.why_not);
      out.close();
    }
    out.close();
    out.line();
  }
  end_table(out);
}

}  // namespace kerf::report
