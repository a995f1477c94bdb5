#pragma once

#include <optional>
#include <vector>

#include "kerf/base/transform.h"
#include "kerf/io/camera.h"
#include "kerf/io/gltf/gltf_file.h"

namespace kerf {

/// A mesh where a node puts it.
struct GltfInstance {
  int mesh = 0;
  Transform place;
};

/// What the nodes of a scene hold, in the order of the tree.
struct GltfScene {
  std::vector<GltfInstance> instances;
  std::optional<Camera> camera;  ///< the first perspective one
};

/// Walks through the default scene; without one through the first, and without any through all nodes that are nobody's
/// child. Fails where a node is met twice or has a transform that is none; says in the notes what has no effect.
GltfScene walk_gltf_scene(GltfFile& file);

}  // namespace kerf
