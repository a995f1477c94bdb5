#pragma once

#include <string>
#include <vector>

#include "kerf/study/report/axis.h"
#include "kerf/study/report/markup.h"

namespace kerf::report {

struct XyPoint {
  double x = 0, y = 0;
  double least = 0, most = 0;  ///< the spread of y; none where they are equal
  std::string label;           ///< beside it; may be empty
  std::string what;            ///< shown when it is pointed at
};

/// The points of one row, in the order in which a line joins them.
struct XySeries {
  size_t number = 1;  ///< of its row: colour, marker and dashes
  std::string label;  ///< at the end of its line; may be empty
  std::vector<XyPoint> points;
};

/// A chart of points, or of lines through them.
struct XyChart {
  std::string id;  ///< of this chart alone on the page
  std::string title, x_title;
  bool lines = false;
  AxisKind x_kind = AxisKind::linear, y_kind = AxisKind::from_zero;
  std::string (*x_text)(double) = nullptr;  ///< a number at the axis
  std::string (*y_text)(double) = nullptr;
  std::vector<double> x_values;  ///< that the axis has room for besides those of the points
  std::vector<XySeries> series;
};

/// Draws the chart as one figure. Labels do not cover each other as long as there is room. Points that have no place
/// on an axis (no number, infinite, or not above zero where it is logarithmic) are left out, and the figure says so.
void draw_xy(Markup& out, const XyChart& chart);

}  // namespace kerf::report
