#pragma once

#include <span>
#include <string>
#include <vector>

#include "kerf/io/scene_description.h"
#include "kerf/study/figures/drawing.h"
#include "kerf/study/figures/figure_work.h"

namespace kerf {

/// Some twenty triangles of different sizes in a plane.
SceneDescription scattered_triangles();

/// A kd-tree and a bounding volume hierarchy with leaves as small.
std::vector<std::string> leaf_rows();

/// The leaf boxes of each pipeline's structure over a scene, side by side (Figure 1 of Ernst and Greiner 2007). A flat
/// scene is seen along the axis of least extent, and boxes are filled: darker where they overlap. Of any other scene
/// the leaf boxes that hold what is seen through about `points` points (see seen_leaves()) are drawn over a shaded
/// picture, as far as they are not hidden;
/// that drawing holds pictures of pixels. Throws Error as build_scene() and CameraRays do, and Error (stopped).
Drawing leaves_figure(const SceneDescription& scene, const Camera& camera, std::span<const std::string> rows,
                      size_t points, const FigureOptions& options);

}  // namespace kerf
