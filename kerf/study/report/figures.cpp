#include "kerf/study/report/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "kerf/study/report/bar_chart.h"
#include "kerf/study/report/columns.h"
#include "kerf/study/report/number_text.h"
#include "kerf/study/report/xy_chart.h"

namespace kerf::report {
namespace {

// Factors from which an axis is logarithmic.
constexpr double kMostLinearReferences = 6;
constexpr double kMostLinear = 40;

using Text = std::string (*)(double);

Text tick_of(const Column& column) {
  if (column.quantity == Quantity::seconds) return seconds_tick;
  return column.quantity == Quantity::bytes ? bytes_tick : number_tick;
}

Text text_of(const Column& column) {
  if (column.quantity == Quantity::seconds) return seconds_text;
  return column.quantity == Quantity::bytes ? bytes_text : number_text;
}

std::string capitalized(std::string_view words) {
  std::string text(words);
  text[0] = static_cast<char>(text[0] - ('a' - 'A'));
  return text;
}

std::vector<double> values_of(ResultSpan results, double (*value)(const StudyResult&)) {
  std::vector<double> values;
  for (const StudyResult* result : results) {
    if (result->finished) values.push_back(value(*result));
  }
  return values;
}

std::vector<size_t> finished_numbers(ResultSpan results, const RowNumbers& numbers) {
  std::vector<size_t> found;
  for (const StudyResult* result : results) {
    const size_t number = numbers.of(result->row);
    if (result->finished && std::find(found.begin(), found.end(), number) == found.end()) found.push_back(number);
  }
  return found;
}

BarChart bars_of(const Column& column, ResultSpan results, const RowNumbers& numbers, const std::string& id) {
  const Unit unit = column_unit(column, results);
  BarChart chart{id + "-bars-" + std::string(column.id), capitalized(column.words), std::string(unit.name), {}};
  for (const StudyResult* result : results) {
    Bar bar{numbers.of(result->row), result->row, result->finished};
    if (result->finished) {
      bar.value = column.value(*result) / unit.size;
      bar.text = value_text(column, column.value(*result), unit);
      const Spread* spread = column.spread != nullptr ? column.spread(*result) : nullptr;
      if (spread != nullptr && spread->count > 1) {
        bar.least = spread->least / unit.size;
        bar.most = spread->most / unit.size;
      }
      // Times of another machine would only press ours together.
      if (result->paper && column.quantity == Quantity::number) bar.paper = column.paper(*result->paper);
    }
    chart.bars.push_back(std::move(bar));
  }
  return chart;
}

/// Ray time of each row against another of its columns.
XyChart scatter(const Column& x, ResultSpan results, const RowNumbers& numbers, const std::string& id) {
  const Column& y = column("trace");
  XyChart chart{id + "-scatter-" + std::string(x.id), fmt::format("Ray time against {}", x.words),
                std::string(x.words)};
  chart.x_kind = axis_kind(values_of(results, x.value), x.id == "references" ? kMostLinearReferences : kMostLinear,
                           AxisKind::linear);
  chart.y_kind = axis_kind(values_of(results, y.value), kMostLinear, AxisKind::from_zero);
  chart.x_text = tick_of(x);
  chart.y_text = tick_of(y);
  for (const StudyResult* result : results) {
    if (!result->finished) continue;
    const size_t number = numbers.of(result->row);
    XyPoint point{x.value(*result), y.value(*result)};
    point.label = std::to_string(number);
    point.what = fmt::format("{} {}: {} {}, ray time {}", number, result->row, x.words, text_of(x)(point.x),
                             seconds_text(point.y));
    chart.series.push_back({number, "", {std::move(point)}});
  }
  return chart;
}

/// A chart of lines of one column.
XyChart lines(const Column& y, AxisKind y_kind, const std::string& id, std::string x_title) {
  XyChart chart{id + "-" + std::string(y.id), capitalized(y.words), std::move(x_title), true};
  chart.y_kind = y_kind;
  chart.x_text = number_tick;
  chart.y_text = tick_of(y);
  return chart;
}

/// The column "time per ray" of growth, which tables do not have: scenes need not have the same number of rays.
constexpr Column kTimePerRay{
    "ray-time", "",
    "",         "time per ray",
    "",         Quantity::seconds,
    Best::none, [](const StudyResult& r) {
                               return r.trace_seconds.median / static_cast<double>(r.ray_count); }};

XySeries growth_line(const Column& y, ResultSpan results, const RowNumbers& numbers, size_t number) {
  XySeries series{number, std::to_string(number), {}};
  for (const StudyResult* result : results) {
    if (!result->finished || numbers.of(result->row) != number) continue;
    XyPoint point{static_cast<double>(result->triangles), y.value(*result)};
    if (const Spread* spread = y.spread != nullptr ? y.spread(*result) : nullptr;
        spread != nullptr && spread->count > 1) {
      point.least = spread->least;
      point.most = spread->most;
    }
    point.what = fmt::format("{} {}: {} triangles, {} {}", number, result->row, count_text(result->triangles), y.words,
                             text_of(y)(point.y));
    series.points.push_back(std::move(point));
  }
  std::stable_sort(series.points.begin(), series.points.end(),
                   [](const XyPoint& a, const XyPoint& b) { return a.x < b.x; });
  return series;
}

void write_key_panel(Markup& out, const std::vector<size_t>& rows, const RowNumbers& numbers, bool with_lines) {
  out.open("div", {{"class", "chart key-panel"}});
  out.element("b", "Rows");
  write_key(out, rows, numbers.names(), with_lines);
  out.close();
}

void write_hint(Markup& out, ResultSpan results) {
  const bool has_paper =
      std::any_of(results.begin(), results.end(), [](const StudyResult* r) { return r->paper.has_value(); });
  out.element("p", {{"class", "hint"}},
              fmt::format("{}{}Whiskers go from the shortest to the longest run.",
                          results.size() > 1 ? "The dashed line stands at the first row that finished. " : "",
                          has_paper ? "A diamond is what the paper printed. " : ""));
}

}  // namespace

void write_scene_charts(Markup& out, ResultSpan results, const RowNumbers& numbers, const std::string& id) {
  const std::vector<size_t> finished = finished_numbers(results, numbers);
  if (finished.empty()) return;
  out.open("div", {{"class", "charts"}});
  for (const char* name : {"nodes", "triangles", "trace"}) draw_bars(out, bars_of(column(name), results, numbers, id));
  out.close();
  write_hint(out, results);
  if (finished.size() < 2) return;
  out.open("div", {{"class", "charts"}});
  draw_xy(out, scatter(column("references"), results, numbers, id));
  draw_xy(out, scatter(column("bytes"), results, numbers, id));
  write_key_panel(out, finished, numbers, false);
  out.close();
}

void write_sweep_charts(Markup& out, ResultSpan results, const std::string& id) {
  const std::vector<double> xs = values_of(results, column("references").value);
  if (xs.empty()) return;
  std::vector<const StudyResult*> sorted(results.begin(), results.end());
  std::stable_sort(sorted.begin(), sorted.end(), [](const StudyResult* a, const StudyResult* b) {
    return a->references_per_triangle < b->references_per_triangle;
  });
  out.open("div", {{"class", "charts"}});
  for (const char* name : {"trace", "nodes", "triangles"}) {
    const Column& y = column(name);
    XyChart chart = lines(y, axis_kind(values_of(results, y.value), kMostLinear, AxisKind::from_zero), id,
                          "references per triangle R");
    chart.x_kind = axis_kind(xs, kMostLinearReferences, AxisKind::linear);
    XySeries series;
    for (const StudyResult* result : sorted) {
      if (!result->finished) continue;
      XyPoint point{result->references_per_triangle, y.value(*result)};
      if (const Spread* spread = y.spread != nullptr ? y.spread(*result) : nullptr; spread != nullptr) {
        point.least = spread->least;
        point.most = spread->most;
      }
      point.label = number_tick(result->sa_max);
      point.what =
          fmt::format("sa_max {}: R {}, {} {}", point.label, number_text(point.x), y.words, text_of(y)(point.y));
      series.points.push_back(std::move(point));
    }
    chart.series.push_back(std::move(series));
    draw_xy(out, chart);
  }
  out.close();
  out.element("p", {{"class", "hint"}}, "The number at each point is its sa_max.");
}

void write_growth_charts(Markup& out, ResultSpan results, const RowNumbers& numbers, const std::string& id) {
  const std::vector<size_t> rows = finished_numbers(results, numbers);
  if (rows.empty()) return;
  out.open("div", {{"class", "charts"}});
  for (const Column* y : {&column("build"), &column("bytes"), &column("nodes"), &kTimePerRay}) {
    XyChart chart = lines(*y, AxisKind::logarithmic, id, "triangles");
    chart.x_kind = AxisKind::logarithmic;
    for (const StudyResult* result : results) chart.x_values.push_back(static_cast<double>(result->triangles));
    for (const size_t number : rows) chart.series.push_back(growth_line(*y, results, numbers, number));
    draw_xy(out, chart);
  }
  write_key_panel(out, rows, numbers, true);
  out.close();
}

}  // namespace kerf::report
