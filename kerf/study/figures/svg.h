#pragma once

#include <string>

#include "kerf/study/figures/drawing.h"

namespace kerf {

/// A drawing as SVG 1.1: rectangles as <rect>, lines and polygons as <path>, text as <text>, groups as <g id="...">.
/// The same drawing gives the same bytes. Throws Error (invalid_argument) for one with pictures of pixels.
std::string svg_text(const Drawing& drawing);

/// Writes a drawing as .png, `scale` pixels for each of its own, or as .svg, by the end of the path; whole or not at
/// all. Throws Error (file) for another end or what cannot be written, Error (invalid_argument) as svg_text().
void write_drawing(const std::string& path, const Drawing& drawing, double scale = 1);

/// Finds out before any work is done what write_drawing() would refuse in the path. Returns whether it is .svg.
bool check_drawing_path(const std::string& path);

}  // namespace kerf
