#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kerf/io/scene_description.h"
#include "kerf/study/figures/drawing.h"
#include "kerf/study/figures/figure_work.h"

namespace kerf {

/// Two long thin triangles that cross, nearly flat in z: what Figure 2 of Ernst and Greiner 2007 is about.
SceneDescription crossing_triangles();

/// Geometry refinement, late and early splitting, so that each of crossing_triangles() becomes four pieces.
std::vector<std::string> splitting_rows();

/// The boxes of each level of each pipeline's tree over a scene (Figure 2 of Ernst and Greiner 2007), seen flat along
/// the axis of least extent: a line of panels for each row, first what the builder is given, then `levels` levels from
/// the root on. A box of one primitive has its colour; one of several is grey. A group for each panel is named
/// "row0-input", "row0-level0", ...; it has a <rect> in SVG for each box. Throws Error as build_scene() does, and Error
/// (stopped).
Drawing levels_figure(const SceneDescription& scene, std::span<const std::string> rows, uint32_t levels,
                      const FigureOptions& options);

}  // namespace kerf
