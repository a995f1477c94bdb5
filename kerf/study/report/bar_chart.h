#pragma once

#include <string>
#include <vector>

#include "kerf/study/report/markup.h"

namespace kerf::report {

struct Bar {
  size_t number = 0;  ///< of its row
  std::string name;
  bool finished = true;
  double value = 0;
  double least = 0, most = 0;  ///< its spread; none where they are equal
  double paper = 0;            ///< what a paper printed, as a mark; none where it is not above 0
  std::string text;            ///< the value to be read
};

/// Bars that lie below each other, each under its name.
struct BarChart {
  std::string id;  ///< of this chart alone on the page
  std::string title;
  std::string unit;  ///< of the numbers at the axis; may be empty
  std::vector<Bar> bars;
};

/// Draws the chart as one figure. Values that differ by more than a hundred stand on a logarithmic axis, as points: a
/// bar without a zero would lie. Charts of the same rows have the same height. A line stands at the first that
/// finished.
void draw_bars(Markup& out, const BarChart& chart);

}  // namespace kerf::report
