#include "kerf/study/report/dot_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "kerf/study/report/axis.h"
#include "kerf/study/report/number_text.h"
#include "kerf/study/report/row_style.h"

namespace kerf::report {
namespace {

// In units of the picture, which are pixels where there is room.
constexpr double kWidth = 760, kLeft = 210, kRight = 740, kTop = 8, kRowHeight = 22, kAxisHeight = 40;
constexpr size_t kNameColumns = 30;

struct Layout {
  Axis axis;
  double bottom = 0;

  double x(double value) const { return kLeft + (kRight - kLeft) * axis.place(value); }
};

std::string vertical(double x, double bottom) {
  return fmt::format("M{} {}V{}", place_text(x), place_text(kTop), place_text(bottom));
}

void draw_axis(Markup& out, const DotChart& chart, const Layout& layout) {
  for (const double tick : layout.axis.ticks) {
    const double x = layout.x(tick);
    out.leaf("path", {{"class", "grid"}, {"d", vertical(x, layout.bottom)}});
    out.element("text", {{"class", "tick middle"}, {"x", place_text(x)}, {"y", place_text(layout.bottom + 15)}},
                number_tick(tick));
  }
  out.leaf("path", {{"class", "first"}, {"d", vertical(layout.x(chart.line), layout.bottom)}});
  out.element(
      "text",
      {{"class", "title middle"}, {"x", place_text((kLeft + kRight) / 2)}, {"y", place_text(layout.bottom + 33)}},
      chart.x_title);
}

void draw_row(Markup& out, const DotRow& row, const Layout& layout, double y) {
  double least = kRight, most = kLeft;
  for (const Dot& dot : row.dots) {
    if (!layout.axis.holds(dot.value)) continue;
    least = std::min(least, layout.x(dot.value));
    most = std::max(most, layout.x(dot.value));
  }
  out.element("text", {{"class", "tick end"}, {"x", place_text(kLeft - 10)}, {"y", place_text(y + 4)}},
              wrapped(row.name, kNameColumns, 1).front());
  if (least > most) return;
  out.leaf("path",
           {{"class", "stem"}, {"d", fmt::format("M{} {}H{}", place_text(least), place_text(y), place_text(most))}});
  for (const Dot& dot : row.dots) {
    if (!layout.axis.holds(dot.value)) continue;
    out.open("g", {{"class", color_class(dot.number)}, {"data-row", std::to_string(dot.number)}});
    draw_marker(out, dot.number, layout.x(dot.value), y, dot.what);
    out.close();
  }
}

}  // namespace

void draw_dots(Markup& out, const DotChart& chart) {
  std::vector<double> values{chart.line};
  for (const DotRow& row : chart.rows) {
    for (const Dot& dot : row.dots) values.push_back(dot.value);
  }
  const Layout layout{make_axis(AxisKind::from_zero, values, 8),
                      kTop + kRowHeight * static_cast<double>(chart.rows.size())};
  out.open("figure", {{"class", "chart wide"}});
  out.open("figcaption");
  out.element("b", chart.title);
  out.close();
  out.open("svg", {{"viewBox", fmt::format("0 0 {} {}", place_text(kWidth), place_text(layout.bottom + kAxisHeight))},
                   {"role", "img"},
                   {"aria-labelledby", chart.id}});
  out.element("title", {{"id", chart.id}}, fmt::format("{}: {} lines", chart.title, chart.rows.size()));
  draw_axis(out, chart, layout);
  double y = kTop + kRowHeight / 2;
  for (const DotRow& row : chart.rows) {
    draw_row(out, row, layout, y);
    y += kRowHeight;
  }
  out.close();
  out.close();
  out.line();
}

}  // namespace kerf::report
