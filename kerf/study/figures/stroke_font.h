#pragma once

#include <string_view>
#include <vector>

#include "kerf/study/figures/drawing.h"

namespace kerf {

/// The width of the pen that text of a size is written with.
constexpr double text_pen(double size) { return 0.085 * size; }

/// How far text reaches; capitals are 0.7 of `size` high.
double text_width(std::string_view text, double size);

/// The lines of one letter each: those of a letter may be drawn as one shape. Letters outside ASCII become a frame, one
/// for each character of UTF-8.
std::vector<std::vector<std::vector<Point2>>> text_strokes(std::string_view text, Point2 at, double size);

}  // namespace kerf
