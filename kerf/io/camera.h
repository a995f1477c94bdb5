#pragma once

#include "kerf/base/vec3.h"

namespace kerf {

/// A pinhole camera. `fov` is the vertical field of view in degrees.
struct Camera {
  Vec3d eye{0, 0, 0};
  Vec3d look_at{0, 0, -1};
  Vec3d up{0, 1, 0};
  double fov = 45;
};

}  // namespace kerf
