#pragma once

#include "kerf/base/box3.h"
#include "kerf/io/scene_description.h"

namespace kerf {

/// The box around all objects of a description.
Box3f bounds_of(const SceneDescription& scene);

/// Adds what a bare model lacks: a sky, and lights for the view of `camera`. A model seen from outside gets two large
/// spheres beside the camera, one seen from within gets lamps along the view, all hidden from the camera.
void add_light(SceneDescription& scene, const Camera& camera);

}  // namespace kerf
