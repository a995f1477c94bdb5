#pragma once

#include <string>

#include "kerf/io/scene_description.h"
#include "kerf/study/figures/drawing.h"
#include "kerf/study/figures/figure_work.h"

namespace kerf {

/// Wireframe on shaded (Figure 3 of Ernst and Greiner 2007): shaded_picture() of a scene with its edges; with `name`
/// not empty, below it the name and the number of primitives. Throws Error as build_scene() and CameraRays do, and
/// Error (stopped).
Drawing wireframe_figure(const SceneDescription& scene, const Camera& camera, const std::string& structure,
                         const std::string& name, const FigureOptions& options);

}  // namespace kerf
