#pragma once

#include "kerf/base/box3.h"
#include "kerf/base/rounding.h"
#include "kerf/geometry/prepared_ray.h"

namespace kerf {

/// A ray for slab tests against boxes within a scene's bounds, made so that no box is missed that holds a hit.
///
/// A plane's distance (b - o) * (1 / d) is off by three roundings, 3 e M in position, where M is the distance from the
/// origin to the farthest side of the scene and e = 2^-24; the primitive tests, in double, are off by far less. So the
/// origin is moved by 8 e M, up for lower sides and down for upper ones: entries come out early and exits late by more
/// than any error, at no cost per node (the idea: Woop, Benthin, Wald 2013, section 4). A direction component of 0 gives
/// infinities of the right sign, and a NaN from 0 * infinity is ignored by the order of the comparisons below.
struct BoxRay {
  Vec3f origin_lower, origin_upper, inverse;
  bool negative[3];

  BoxRay(const PreparedRay& ray, const Box3f& scene_bounds) {
    const Vec3d below = abs(to_double(scene_bounds.lower) - ray.origin_d);
    const Vec3d above = abs(to_double(scene_bounds.upper) - ray.origin_d);
    const double shift = 0x1p-21 * largest(max(below, above));
    for (uint32_t axis = 0; axis < 3; ++axis) {
      origin_lower[axis] = round_up(ray.origin_d[axis] + shift);
      origin_upper[axis] = round_down(ray.origin_d[axis] - shift);
      inverse[axis] = 1 / static_cast<float>(ray.direction_d[axis]);
      negative[axis] = ray.direction_d[axis] < 0;
    }
  }

  /// Where the ray enters the box, at the earliest, and whether it may within [t_min, limit].
  bool enters(const Vec3f& lower, const Vec3f& upper, float t_min, float limit, float& entry) const {
    float near = t_min, far = limit;
    for (uint32_t axis = 0; axis < 3; ++axis) {
      const float t_lower = (lower[axis] - origin_lower[axis]) * inverse[axis];
      const float t_upper = (upper[axis] - origin_upper[axis]) * inverse[axis];
      const float t_near = negative[axis] ? t_upper : t_lower;
      const float t_far = negative[axis] ? t_lower : t_upper;
      near = t_near > near ? t_near : near;
      far = t_far < far ? t_far : far;
    }
    entry = near;
    return near <= far;
  }
};

}  // namespace kerf
