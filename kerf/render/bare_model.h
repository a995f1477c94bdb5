#pragma once

#include "kerf/base/box3.h"
#include "kerf/io/scene_description.h"
#include "kerf/scene/scene.h"

namespace kerf {

/// The box around all objects of a description.
Box3f bounds_of(const SceneDescription& scene);

/// Adds what a bare model lacks: a sky, and lights for the view of `camera`. A model seen from outside gets two large
/// spheres beside the camera; one seen from within gets lamps along the view, as bright as a small picture of it,
/// traced in the structure of `build`, shows to be right. All are hidden from the camera. Throws Error as RenderScene
/// does.
void add_light(SceneDescription& scene, const Camera& camera, const BuildOptions& build = {});

}  // namespace kerf
