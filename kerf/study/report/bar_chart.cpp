#include "kerf/study/report/bar_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "kerf/study/report/axis.h"
#include "kerf/study/report/number_text.h"
#include "kerf/study/report/row_style.h"

namespace kerf::report {
namespace {

// In units of the picture, which are pixels where there is room.
constexpr double kWidth = 380, kLeft = 26, kRight = 300;  // bars lie between; behind them stand their values
constexpr double kNameLine = 14, kBarHeight = 11, kGap = 10, kAxisHeight = 24;
constexpr size_t kNameColumns = 52, kNameLines = 3;
constexpr double kMostBarRatio = 100;
constexpr double kDigitWidth = 6.6;
constexpr double kPoint = 4.5;

struct Layout {
  Axis axis;
  bool points = false;  ///< a point for each value in place of a bar
  double height = 0;

  double x(double value) const { return kLeft + (kRight - kLeft) * std::clamp(axis.place(value), 0.0, 1.0); }
};

std::vector<std::string> name_lines(const Bar& bar) { return wrapped(bar.name, kNameColumns, kNameLines); }

double bar_height(const Bar& bar) {
  return static_cast<double>(name_lines(bar).size()) * kNameLine + kBarHeight + kGap;
}

/// Bars need no mark beyond the longest of them.
void end_at_values(Axis& axis, const std::vector<double>& values) {
  double most = 0;
  for (const double value : values) {
    if (axis.holds(value)) most = std::max(most, value);
  }
  if (most == 0) return;
  axis.most = most;
  std::erase_if(axis.ticks, [&](double tick) { return tick > most; });
}

Layout make_layout(const BarChart& chart) {
  std::vector<double> values, all;
  double height = kAxisHeight;
  for (const Bar& bar : chart.bars) {
    height += bar_height(bar);
    if (!bar.finished) continue;
    values.push_back(bar.value);
    all.insert(all.end(), {bar.value, bar.paper});
    if (bar.least < bar.most) all.insert(all.end(), {bar.least, bar.most});
  }
  const AxisKind kind = axis_kind(values, kMostBarRatio, AxisKind::from_zero);
  Layout layout{make_axis(kind, all, 4), kind == AxisKind::logarithmic, height};
  if (!layout.points) end_at_values(layout.axis, all);
  return layout;
}

void draw_grid(Markup& out, const BarChart& chart, const Layout& layout) {
  const std::string bottom = place_text(layout.height - kAxisHeight + 4);
  double free_from = -1;
  for (const double tick : layout.axis.ticks) {
    const double x = layout.x(tick);
    const std::string text = number_tick(tick);
    const double half = static_cast<double>(text_columns(text)) * kDigitWidth / 2;
    out.leaf("path", {{"class", "grid"}, {"d", fmt::format("M{} 0V{}", place_text(x), bottom)}});
    if (x - half < free_from) continue;
    out.element("text",
                {{"class", "tick middle"}, {"x", place_text(x)}, {"y", place_text(layout.height - kAxisHeight + 17)}},
                text);
    free_from = x + half + 6;
  }
  if (!chart.unit.empty()) {
    out.element("text", {{"class", "tick"}, {"x", "318"}, {"y", place_text(layout.height - kAxisHeight + 17)}},
                chart.unit);
  }
  for (const Bar& bar : chart.bars) {
    if (!bar.finished) continue;
    if (!layout.axis.holds(bar.value) || chart.bars.size() == 1) break;
    out.leaf("path", {{"class", "first"}, {"d", fmt::format("M{} 0V{}", place_text(layout.x(bar.value)), bottom)}});
    break;
  }
}

void draw_spread(Markup& out, const Bar& bar, const Layout& layout, double middle) {
  if (!(bar.least < bar.most) || !layout.axis.holds(bar.least) || !layout.axis.holds(bar.most)) return;
  if (layout.points && layout.x(bar.most) - layout.x(bar.least) < 2 * kPoint) return;  // hidden by the point
  out.leaf("path", {{"class", "spread"},
                    {"d", fmt::format("M{0} {2}V{3}M{1} {2}V{3}M{0} {4}H{1}", place_text(layout.x(bar.least)),
                                      place_text(layout.x(bar.most)), place_text(middle - 3.5),
                                      place_text(middle + 3.5), place_text(middle))}});
}

void draw_value(Markup& out, const Bar& bar, const Layout& layout, double y) {
  const double middle = y + kBarHeight / 2;
  double end = kLeft;
  if (!bar.finished) {
    out.element("text", {{"class", "missing"}, {"x", place_text(kLeft)}, {"y", place_text(middle + 4)}},
                "not finished");
    return;
  }
  if (layout.axis.holds(bar.value)) {
    const double x = layout.x(bar.value);
    end = std::max(end, x + (layout.points ? 5 : 0));
    if (layout.points) {
      out.leaf("path", {{"class", "stem"},
                        {"d", fmt::format("M{} {}H{}", place_text(kLeft), place_text(middle), place_text(x))}});
      out.leaf("circle",
               {{"class", "bar"}, {"cx", place_text(x)}, {"cy", place_text(middle)}, {"r", place_text(kPoint)}});
    } else {
      out.leaf("rect", {{"class", "bar"},
                        {"x", place_text(kLeft)},
                        {"y", place_text(y)},
                        {"width", place_text(x - kLeft)},
                        {"height", place_text(kBarHeight)},
                        {"rx", "1.5"}});
    }
    draw_spread(out, bar, layout, middle);
    if (bar.least < bar.most && layout.axis.holds(bar.most)) end = std::max(end, layout.x(bar.most));
  }
  if (bar.paper > 0 && layout.axis.holds(bar.paper)) {
    const double x = layout.x(bar.paper);
    out.leaf("path", {{"class", "paper-mark"},
                      {"d", "M0 -6L4.5 0L0 6L-4.5 0Z"},
                      {"transform", fmt::format("translate({} {})", place_text(x), place_text(middle))}});
    if (x < end + 60) end = std::max(end, x + 5);
  }
  out.element("text", {{"class", "value"}, {"x", place_text(end + 5)}, {"y", place_text(middle + 4)}}, bar.text);
}

void draw_bar(Markup& out, const Bar& bar, const Layout& layout, double y) {
  out.open("g", {{"data-row", std::to_string(bar.number)}});
  out.element("title", fmt::format("{} {}: {}", bar.number, bar.name, bar.finished ? bar.text : "not finished"));
  out.leaf("rect", {{"class", "hover"},
                    {"x", "0"},
                    {"y", place_text(y - 2)},
                    {"width", place_text(kWidth)},
                    {"height", place_text(bar_height(bar) - kGap + 5)}});
  double line = y + kNameLine - 4;
  out.element("text", {{"class", "number"}, {"x", place_text(kLeft - 7)}, {"y", place_text(line)}},
              std::to_string(bar.number));
  for (const std::string& text : name_lines(bar)) {
    out.element("text", {{"class", "name"}, {"x", place_text(kLeft)}, {"y", place_text(line)}}, text);
    line += kNameLine;
  }
  draw_value(out, bar, layout, y + bar_height(bar) - kGap - kBarHeight);
  out.close();
}

}  // namespace

void draw_bars(Markup& out, const BarChart& chart) {
  const Layout layout = make_layout(chart);
  out.open("figure", {{"class", "chart"}});
  out.open("figcaption");
  out.element("b", chart.title);
  if (layout.points) out.element("span", {{"class", "scale"}}, " logarithmic scale");
  out.close();
  out.open("svg", {{"viewBox", fmt::format("0 0 {} {}", place_text(kWidth), place_text(layout.height))},
                   {"role", "img"},
                   {"aria-labelledby", chart.id}});
  out.element("title", {{"id", chart.id}},
              fmt::format("{}: {} rows; the same numbers stand in the table", chart.title, chart.bars.size()));
  draw_grid(out, chart, layout);
  double y = 2;
  for (const Bar& bar : chart.bars) {
    draw_bar(out, bar, layout, y);
    y += bar_height(bar);
  }
  out.close();
  out.close();
  out.line();
}

}  // namespace kerf::report
