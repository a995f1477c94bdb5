#pragma once

#include <string>
#include <vector>

#include "kerf/study/report/markup.h"

namespace kerf::report {

struct Dot {
  size_t number = 1;  ///< of its kind: colour and marker
  double value = 0;   ///< left out where it is no number
  std::string what;   ///< shown when it is pointed at
};

/// One line of a chart: a name, and dots on the same scale as those of all other lines.
struct DotRow {
  std::string name;
  std::vector<Dot> dots;
};

struct DotChart {
  std::string id;  ///< of this chart alone on the page
  std::string title, x_title;
  double line = 1;  ///< where a dashed line stands
  std::vector<DotRow> rows;
};

/// Draws the chart as one figure, from 0 on.
void draw_dots(Markup& out, const DotChart& chart);

}  // namespace kerf::report
