#pragma once

#include "kerf/base/box3.h"
#include "kerf/base/rounding.h"
#include "kerf/geometry/prepared_ray.h"

namespace kerf {

/// A ray's origin, moved so that no box is missed that holds a hit, whatever the box test.
///
/// A plane's distance (b - o) * (1 / d) is off by three roundings, 3 e M in position, where M is the distance from the
/// origin to the farthest side of the scene and e = 2^-24; the primitive tests, in double, are off by far less. So the
/// origin is moved by 8 e M, up for lower sides and down for upper ones: entries come out early and exits late by more
/// than any error, at no cost per node (the idea: Woop, Benthin, Wald 2013, section 4).
struct MovedOrigin {
  Vec3f for_lower, for_upper;

  MovedOrigin(const PreparedRay& ray, const Box3f& scene_bounds) {
    const Vec3d below = abs(to_double(scene_bounds.lower) - ray.origin_d);
    const Vec3d above = abs(to_double(scene_bounds.upper) - ray.origin_d);
    const double shift = 0x1p-21 * largest(max(below, above));
    for (uint32_t axis = 0; axis < 3; ++axis) {
      for_lower[axis] = round_up(ray.origin_d[axis] + shift);
      for_upper[axis] = round_down(ray.origin_d[axis] - shift);
    }
  }
};

/// Which sides of boxes are near and far for a ray, and the moved origin for each.
struct Sides {
  Vec3f origin_near, origin_far;
  uint32_t near_side[3], far_side[3];  ///< where a box stores its near and far side of each axis

  /// Boxes are seven floats: three lower sides, something else, three upper sides, as in Bvh2Child.
  static constexpr uint32_t kLower = 0, kUpper = 4;

  Sides(const PreparedRay& ray, const Box3f& scene_bounds) {
    const MovedOrigin origin(ray, scene_bounds);
    for (uint32_t axis = 0; axis < 3; ++axis) {
      const bool negative = ray.direction_d[axis] < 0;
      origin_near[axis] = negative ? origin.for_upper[axis] : origin.for_lower[axis];
      origin_far[axis] = negative ? origin.for_lower[axis] : origin.for_upper[axis];
      near_side[axis] = (negative ? kUpper : kLower) + axis;
      far_side[axis] = (negative ? kLower : kUpper) + axis;
    }
  }
};

/// A ray for slab tests against boxes within a scene's bounds. A direction component of 0 gives infinities of the right
/// sign, and a NaN from 0 * infinity is ignored by the order of the comparisons below.
struct BoxRay : Sides {
  Vec3f inverse;

  BoxRay(const PreparedRay& ray, const Box3f& scene_bounds) : Sides(ray, scene_bounds) {
    for (uint32_t axis = 0; axis < 3; ++axis) inverse[axis] = 1 / static_cast<float>(ray.direction_d[axis]);
  }

  /// Where the ray enters the box, at the earliest, and whether it may within [t_min, limit].
  bool enters(const float* box, float t_min, float limit, float& entry) const {
    float near = t_min, far = limit;
    for (uint32_t axis = 0; axis < 3; ++axis) {
      const float t_near = (box[near_side[axis]] - origin_near[axis]) * inverse[axis];
      const float t_far = (box[far_side[axis]] - origin_far[axis]) * inverse[axis];
      near = t_near > near ? t_near : near;
      far = t_far < far ? t_far : far;
    }
    entry = near;
    return near <= far;
  }
};

}  // namespace kerf
