#include "kerf/study/report/xy_chart.h"

#include <fmt/format.h>

#include <algorithm>

#include "kerf/study/report/label_places.h"
#include "kerf/study/report/number_text.h"
#include "kerf/study/report/row_style.h"

namespace kerf::report {
namespace {

// In units of the picture, which are pixels where there is room.
constexpr double kWidth = 380, kLeft = 52, kTop = 10, kBottomMargin = 40;
constexpr double kRightOfPoints = 12, kRightOfLines = 34;  // labels of lines stand in the margin
constexpr double kLeastHeight = 290, kHeightOfManyLines = 400;
constexpr size_t kManyLines = 6;
constexpr double kLabelHeight = 12, kDigitWidth = 7.7;
constexpr double kInset = 8;  // so that no marker stands on the axis
constexpr double kMarker = 5.5;

struct Layout {
  Axis x, y;
  double right = 0, bottom = 0;

  double place_x(double value) const { return kLeft + kInset + (right - kLeft - 2 * kInset) * x.place(value); }
  double place_y(double value) const { return bottom - (bottom - kTop) * y.place(value); }
  bool holds(const XyPoint& p) const { return x.holds(p.x) && y.holds(p.y); }
  bool holds_spread(const XyPoint& p) const { return p.least < p.most && y.holds(p.least) && y.holds(p.most); }
};

double width_of(const std::string& text) { return static_cast<double>(text_columns(text)) * kDigitWidth; }

bool has_labels_at_ends(const XyChart& chart) {
  return chart.lines &&
         std::any_of(chart.series.begin(), chart.series.end(), [](const XySeries& s) { return !s.label.empty(); });
}

Layout make_layout(const XyChart& chart) {
  std::vector<double> xs = chart.x_values, ys;
  for (const XySeries& series : chart.series) {
    for (const XyPoint& p : series.points) {
      xs.push_back(p.x);
      ys.push_back(p.y);
      if (p.least < p.most) ys.insert(ys.end(), {p.least, p.most});
    }
  }
  const double labels = static_cast<double>(chart.series.size()) * kLabelHeight + kTop + kBottomMargin;
  const double least = chart.series.size() > kManyLines ? kHeightOfManyLines : kLeastHeight;
  const double height = has_labels_at_ends(chart) ? std::max(least, labels) : kLeastHeight;
  return {make_axis(chart.x_kind, xs, 5), make_axis(chart.y_kind, ys, 5),
          kWidth - (has_labels_at_ends(chart) ? kRightOfLines : kRightOfPoints), height - kBottomMargin};
}

void draw_text(Markup& out, std::string_view kind, double x, double y, std::string_view text) {
  out.element("text", {{"class", kind}, {"x", place_text(x)}, {"y", place_text(y)}}, text);
}

void draw_axes(Markup& out, const XyChart& chart, const Layout& layout) {
  const auto line = [&](std::string_view kind, double x0, double y0, double x1, double y1) {
    out.leaf("path",
             {{"class", kind},
              {"d", fmt::format("M{} {}L{} {}", place_text(x0), place_text(y0), place_text(x1), place_text(y1))}});
  };
  double free_from = 0;
  for (const double tick : layout.x.ticks) {
    const double x = layout.place_x(tick);
    const std::string text = chart.x_text(tick);
    const double half = width_of(text) / 2;
    line("grid", x, kTop, x, layout.bottom);
    if (x - half < free_from || x + half > kWidth) continue;
    draw_text(out, "tick middle", x, layout.bottom + 15, text);
    free_from = x + half + 6;
  }
  double free_below = layout.bottom + kLabelHeight;
  for (const double tick : layout.y.ticks) {
    const double y = layout.place_y(tick);
    line("grid", kLeft, y, layout.right, y);
    if (y > free_below) continue;
    draw_text(out, "tick end", kLeft - 6, y + 4, chart.y_text(tick));
    free_below = y - kLabelHeight;
  }
  line("axis", kLeft, layout.bottom, layout.right, layout.bottom);
  draw_text(out, "title middle", (kLeft + layout.right) / 2, layout.bottom + 33, chart.x_title);
}

/// The line through a row's points, and the spread of each.
void draw_line(Markup& out, const XyChart& chart, const Layout& layout, const XySeries& series) {
  std::string path, spreads;
  for (const XyPoint& p : series.points) {
    if (!layout.holds(p)) continue;
    const std::string x = place_text(layout.place_x(p.x));
    path += fmt::format("{}{} {}", path.empty() ? 'M' : 'L', x, place_text(layout.place_y(p.y)));
    if (layout.holds_spread(p)) {
      spreads += fmt::format("M{} {}V{}", x, place_text(layout.place_y(p.least)), place_text(layout.place_y(p.most)));
    }
  }
  if (chart.lines && !path.empty()) {
    out.leaf("path", {{"class", "line"}, {"d", path}, {"stroke-dasharray", dashes(series.number)}});
  }
  if (!spreads.empty()) out.leaf("path", {{"class", "spread"}, {"d", spreads}});
}

void draw_series(Markup& out, const XyChart& chart, const Layout& layout) {
  for (const XySeries& series : chart.series) {
    out.open("g", {{"class", color_class(series.number)}, {"data-row", std::to_string(series.number)}});
    draw_line(out, chart, layout, series);
    for (const XyPoint& p : series.points) {
      if (layout.holds(p)) draw_marker(out, series.number, layout.place_x(p.x), layout.place_y(p.y), p.what);
    }
    out.close();
  }
}

/// Joins a label to its point where it stands off.
void draw_leader(Markup& out, double x, double y, const Area& label) {
  const double near_x = std::clamp(x, label.left, label.right), near_y = std::clamp(y, label.top, label.bottom);
  if ((near_x - x) * (near_x - x) + (near_y - y) * (near_y - y) < 12 * 12) return;
  out.leaf("path",
           {{"class", "leader"},
            {"d", fmt::format("M{} {}L{} {}", place_text(x), place_text(y), place_text(near_x), place_text(near_y))}});
}

/// Keeps labels off the lines.
void block_lines(LabelPlaces& places, const XySeries& series, const Layout& layout) {
  constexpr int kSteps = 24;
  const XyPoint* last = nullptr;
  for (const XyPoint& p : series.points) {
    if (!layout.holds(p)) continue;
    for (int i = 1; last != nullptr && i < kSteps; ++i) {
      const double s = static_cast<double>(i) / kSteps;
      const double x = layout.place_x(last->x) * (1 - s) + layout.place_x(p.x) * s;
      const double y = layout.place_y(last->y) * (1 - s) + layout.place_y(p.y) * s;
      places.block({x - 1, y - 1, x + 1, y + 1});
    }
    last = &p;
  }
}

void draw_point_labels(Markup& out, const XyChart& chart, const Layout& layout) {
  LabelPlaces places(
      {kLeft + 1, kTop - 8, layout.right + (has_labels_at_ends(chart) ? 0 : kRightOfPoints), layout.bottom});
  for (const XySeries& series : chart.series) {
    if (chart.lines) block_lines(places, series, layout);
    for (const XyPoint& p : series.points) {
      if (!layout.holds(p)) continue;
      const double x = layout.place_x(p.x), y = layout.place_y(p.y);
      places.block({x - kMarker, y - kMarker, x + kMarker, y + kMarker});
    }
  }
  for (const XySeries& series : chart.series) {
    for (const XyPoint& p : series.points) {
      if (p.label.empty() || !layout.holds(p)) continue;
      const double x = layout.place_x(p.x), y = layout.place_y(p.y);
      const Area area = places.place(x, y, width_of(p.label), kLabelHeight);
      out.open("g", {{"data-row", std::to_string(series.number)}});
      draw_leader(out, x, y, area);
      draw_text(out, "label middle", (area.left + area.right) / 2, area.bottom - 2.5, p.label);
      out.close();
    }
  }
}

/// Labels of lines, in a column at the right.
void draw_end_labels(Markup& out, const XyChart& chart, const Layout& layout) {
  struct End {
    const XySeries* series;
    double x, y;
  };
  std::vector<End> ends;
  std::vector<double> middles;
  for (const XySeries& series : chart.series) {
    const auto last =
        std::find_if(series.points.rbegin(), series.points.rend(), [&](const XyPoint& p) { return layout.holds(p); });
    if (series.label.empty() || last == series.points.rend()) continue;
    ends.push_back({&series, layout.place_x(last->x), layout.place_y(last->y)});
    middles.push_back(ends.back().y);
  }
  const std::vector<double> placed = spread_column(middles, kLabelHeight, kTop, layout.bottom);
  for (size_t i = 0; i < ends.size(); ++i) {
    const auto& [series, x, y] = ends[i];
    out.open("g", {{"class", color_class(series->number)}, {"data-row", std::to_string(series->number)}});
    out.leaf("path", {{"class", "leader"},
                      {"d", fmt::format("M{} {}L{} {}", place_text(x + kMarker), place_text(y),
                                        place_text(layout.right + 13), place_text(placed[i]))}});
    draw_text(out, "label", layout.right + 15, placed[i] + 4, series->label);
    out.close();
  }
}

size_t count_left_out(const XyChart& chart, const Layout& layout) {
  size_t count = 0;
  for (const XySeries& series : chart.series) {
    count += static_cast<size_t>(
        std::count_if(series.points.begin(), series.points.end(), [&](const XyPoint& p) { return !layout.holds(p); }));
  }
  return count;
}

}  // namespace

void draw_xy(Markup& out, const XyChart& chart) {
  const Layout layout = make_layout(chart);
  out.open("figure", {{"class", "chart"}});
  out.open("figcaption");
  out.element("b", chart.title);
  const bool log_x = chart.x_kind == AxisKind::logarithmic, log_y = chart.y_kind == AxisKind::logarithmic;
  if (log_x || log_y) {
    out.element("span", {{"class", "scale"}},
                log_x && log_y ? " logarithmic scales"
                : log_x        ? " logarithmic in x"
                               : " logarithmic in y");
  }
  if (const size_t left_out = count_left_out(chart, layout); left_out > 0) {
    out.element("span", {{"class", "left-out"}},
                fmt::format(" {} {} no place on these axes", left_out, left_out == 1 ? "point has" : "points have"));
  }
  out.close();
  out.open("svg", {{"viewBox", fmt::format("0 0 {} {}", place_text(kWidth), place_text(layout.bottom + kBottomMargin))},
                   {"role", "img"},
                   {"aria-labelledby", chart.id}});
  out.element("title", {{"id", chart.id}}, fmt::format("{} against {}", chart.title, chart.x_title));
  draw_axes(out, chart, layout);
  draw_series(out, chart, layout);
  draw_point_labels(out, chart, layout);
  if (chart.lines) draw_end_labels(out, chart, layout);
  out.close();
  out.close();
  out.line();
}

}  // namespace kerf::report
