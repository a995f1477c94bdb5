#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "kerf/render/camera.h"
#include "kerf/render/render_scene.h"

namespace kerf {

/// What the rays of a picture cost in a structure.
struct StructureCost {
  std::string structure;  ///< the pipeline in its canonical spelling
  double references_per_primitive = 0;
  double nodes_per_ray = 0, primitives_per_ray = 0;
  double seconds = 0;  ///< the median of several runs over all rays, which take turns with the other structures'
  uint64_t rays = 0;
};

/// Traces the same rays through several structures over one scene: a camera ray for each pixel of a picture of some
/// 30,000 pixels, and a ray in a random direction from each hit.
std::vector<StructureCost> compare_structures(const SceneDescription& description, const Camera& camera, double aspect,
                                              std::span<const BuildOptions> structures);

}  // namespace kerf
