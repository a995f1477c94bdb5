#pragma once

#include <vector>

#include "kerf/io/camera.h"
#include "kerf/study/figures/figure_work.h"
#include "kerf/study/figures/tree_boxes.h"

namespace kerf {

/// The leaves of a structure that hold what a camera sees through about `count` points, spread evenly over a picture:
/// each once, in the structure's order. The points do not depend on the structure, so that what is shown of two can be
/// compared. Throws Error as CameraRays does.
std::vector<TreeBox> seen_leaves(const Scene& scene, const Camera& camera, size_t count, const FigureOptions& options);

}  // namespace kerf
