#include "kerf/study/report/splitting_figures.h"

#include <fmt/format.h>

#include <cmath>

#include "kerf/study/report/dot_chart.h"
#include "kerf/study/report/number_text.h"
#include "kerf/study/report/row_style.h"
#include "kerf/study/report/xy_chart.h"
#include "kerf/study/splitting_tables.h"

namespace kerf::report {
namespace {

using Role = SplittingRole;

/// What is marked in the charts, by colour and marker; the sweep is drawn as a line.
constexpr Role kMarked[] = {Role::automatic, Role::spatial_split, Role::balanced,
                            Role::best,      Role::fast,          Role::embree_high};
constexpr size_t kSweepNumber = std::size(kMarked) + 1;

size_t number_of(Role role) {
  for (size_t i = 0; i < std::size(kMarked); ++i) {
    if (kMarked[i] == role) return i + 1;
  }
  return kSweepNumber;
}

std::vector<std::string> key_names(std::string sweep) {
  std::vector<std::string> names;
  for (const Role role : kMarked) names.emplace_back(splitting_row(role).name);
  names.push_back(std::move(sweep));
  return names;
}

/// A row's place in a chart of one kind of rays, or of all.
using Share = double (*)(const SplittingScene&, const SplittingRow&, size_t);

XyPoint point_of(const SplittingScene& scene, const SplittingRow& row, Share share, size_t kind) {
  XyPoint point{row.references_per_primitive, share(scene, row, kind)};
  point.what = fmt::format("{}: R {}, {} of the visits", row_name(row), number_text(point.x), number_text(point.y));
  return point;
}

XyChart curve_chart(const SplittingScene& scene, Share share, size_t kind, const std::string& id,
                    const std::string& title) {
  XyChart chart{id, title, "references per primitive R", true};
  chart.x_text = chart.y_text = number_tick;
  chart.x_values = {1};
  XySeries sweep{kSweepNumber, "", {}};
  if (const SplittingRow* plain = scene.row(Role::plain)) {
    sweep.points.push_back(point_of(scene, *plain, share, kind));
    sweep.points.back().what = "plain: nothing is split";
  }
  for (const SplittingRow& row : scene.rows) {
    if (row.role == Role::budget && row.finished) sweep.points.push_back(point_of(scene, row, share, kind));
  }
  chart.series.push_back(std::move(sweep));
  for (const Role role : kMarked) {
    const SplittingRow* row = scene.row(role);
    if (row == nullptr) continue;
    XyPoint point = point_of(scene, *row, share, kind);
    point.label = splitting_row(role).name;
    chart.series.push_back({number_of(role), "", {std::move(point)}});
  }
  return chart;
}

double share_of_kind(const SplittingScene& scene, const SplittingRow& row, size_t kind) {
  return visits_share(scene, row, kind);
}

double share_of_all(const SplittingScene& scene, const SplittingRow& row, size_t /*kind*/) {
  return visits_share(scene, row);
}

std::vector<size_t> numbers_in(std::span<const SplittingScene> scenes) {
  std::vector<size_t> numbers;
  for (const Role role : kMarked) {
    for (const SplittingScene& scene : scenes) {
      if (scene.row(role) == nullptr) continue;
      numbers.push_back(number_of(role));
      break;
    }
  }
  numbers.push_back(kSweepNumber);
  return numbers;
}

void write_key_panel(Markup& out, std::span<const SplittingScene> scenes, const std::string& sweep, bool lines) {
  const std::vector<std::string> names = key_names(sweep);
  out.open("div", {{"class", "chart key-panel"}});
  out.open("ul", {{"class", "key"}});
  for (const size_t number : numbers_in(scenes)) {
    out.open("li", {{"data-row", std::to_string(number)}});
    write_key_mark(out, number, lines && number == kSweepNumber);
    out.text(names[number - 1]);
    out.close();
  }
  out.close();
  out.close();
  out.line();
}

}  // namespace

void write_choice_chart(Markup& out, const SplitChoice& choice, const std::string& id) {
  XyChart chart{id, "Why auto stopped: predicted cost", "references per primitive R", true};
  chart.x_text = chart.y_text = number_tick;
  chart.y_kind = AxisKind::linear;
  chart.x_values = {1};
  XySeries curve{1, "", {}};
  for (const SplitChoice::Step& step : choice.curve) {
    XyPoint point{step.references_per_primitive, step.cost};
    point.what = fmt::format("R {}: cost {}", number_text(point.x), number_text(point.y));
    curve.points.push_back(std::move(point));
  }
  if (!curve.points.empty()) curve.points.back().label = "chosen";
  chart.series.push_back(std::move(curve));
  draw_xy(out, chart);
}

void write_splitting_charts(Markup& out, const SplittingScene& scene, const std::string& id) {
  if (scene.row(Role::plain) == nullptr) return;
  const SplittingRow* automatic = scene.row(Role::automatic);
  out.open("div", {{"class", "charts"}});
  draw_xy(out, curve_chart(scene, share_of_all, 0, id + "-all", "Visits of all kinds of rays, as a share of plain's"));
  if (automatic != nullptr && automatic->choice) write_choice_chart(out, *automatic->choice, id + "-choice");
  write_key_panel(out, {&scene, 1}, "budgets, from plain on", true);
  out.close();
  out.open("details");
  out.element("summary", "Each kind of rays by itself");
  out.open("div", {{"class", "charts"}});
  for (size_t k = 0; k < scene.kinds.size(); ++k) {
    if (scene.ray_counts[k] == 0) continue;
    draw_xy(out, curve_chart(scene, share_of_kind, k, fmt::format("{}-{}", id, k + 1),
                             fmt::format("Visits of {} rays, as a share of plain's", scene.kinds[k])));
  }
  out.close();
  out.close();
  out.line();
}

void write_splitting_overview(Markup& out, std::span<const SplittingScene> scenes, const std::string& id) {
  DotChart chart{id, "What is left of plain's visits, all kinds of rays", "visits, as a share of plain's", 1, {}};
  for (const SplittingScene& scene : scenes) {
    DotRow line{scene.title(), {}};
    const auto add = [&](const SplittingRow* row) {
      if (row == nullptr) return;
      const double share = visits_share(scene, *row);
      line.dots.push_back({number_of(row->role), share,
                           fmt::format("{}, {}: {} at R {}", line.name, row_name(*row), number_text(share),
                                       number_text(row->references_per_primitive))});
    };
    add(best_of_sweep(scene));
    for (auto role = std::rbegin(kMarked); role != std::rend(kMarked); ++role) add(scene.row(*role));  // auto on top
    chart.rows.push_back(std::move(line));
  }
  draw_dots(out, chart);
  write_key_panel(out, scenes, "best budget of the sweep", false);
}

}  // namespace kerf::report
