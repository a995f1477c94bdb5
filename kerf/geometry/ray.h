#pragma once

#include <cstdint>
#include <limits>

#include "kerf/base/vec3.h"

namespace kerf {

/// A ray: the points origin + t * direction for t in [t_min, t_max], both ends included. 40 bytes.
///
/// The direction need not be of unit length; t counts in its lengths. t_min may be negative. A ray hits nothing if its
/// origin is not finite or has a component above 2^120, if the largest component of its direction lies outside
/// [2^-100, 2^100] (so also if it is zero or not finite), if an end of its interval is NaN or if t_min > t_max.
struct Ray {
  Vec3f origin;
  float t_min = 0;
  Vec3f direction;
  float t_max = std::numeric_limits<float>::infinity();
  float time = 0;               ///< in [0, 1]; only moving geometry will look at it, and none moves yet
  uint32_t mask = 0xFFFFFFFFU;  ///< a geometry is seen if its mask and this one share a bit
};
static_assert(sizeof(Ray) == 40);

}  // namespace kerf
