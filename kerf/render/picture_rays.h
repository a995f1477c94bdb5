#pragma once

#include <vector>

#include "kerf/io/camera.h"
#include "kerf/scene/scene.h"

namespace kerf {

/// A primary ray through each pixel and a cosine-distributed one from each of their hits, in that order.
struct PictureRays {
  std::vector<Ray> rays;
  size_t primary = 0;
};
PictureRays picture_rays(const Scene& scene, const Camera& camera, uint32_t width, uint32_t height);

}  // namespace kerf
