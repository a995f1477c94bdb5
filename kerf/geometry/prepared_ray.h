#pragma once

#include <algorithm>
#include <cmath>

#include "kerf/geometry/ray.h"
#include "kerf/geometry/shapes.h"

namespace kerf {

/// What the primitive tests need of a ray, computed once: the shear that makes the ray the z axis (Woop, Benthin, Wald:
/// Watertight Ray/Triangle Intersection, 2013), in float for the filter and in double for the decision.
struct PreparedRay {
  Vec3f origin;
  uint32_t kx = 0, ky = 1, kz = 2;  ///< kz: the axis along which the direction is largest
  float t_min = 0, t_max = 0;
  float shear_x = 0, shear_y = 0;
  Vec3d origin_d, direction_d;
  double shear_xd = 0, shear_yd = 0;
  uint32_t mask = 0;
  bool valid = false;  ///< false: the ray hits nothing, see Ray

  /// Without branches that would be mispredicted: a ray has few nodes to pay for them.
  explicit PreparedRay(const Ray& ray) {
    const Vec3f sides = abs(ray.direction), place = abs(ray.origin);
    const auto all_at_most = [](Vec3f a, float limit) {  // false for what is not a number
      return (a.x <= limit) & (a.y <= limit) & (a.z <= limit);
    };
    valid = (all_at_most(place, kMaxCoordinate) & all_at_most(sides, 0x1p100F) & (ray.t_min <= ray.t_max)) != 0 &&
            largest(sides) >= 0x1p-100F;
    if (!valid) return;
    origin = cleaned(ray.origin);
    t_min = ray.t_min;
    t_max = ray.t_max;
    mask = ray.mask;
    // largest_axis(), and the axes after it in turn.
    const auto y_is_larger = static_cast<uint32_t>(sides.x < sides.y);
    const auto z_is_largest = static_cast<uint32_t>(std::max(sides.x, sides.y) < sides.z);
    kz = (y_is_larger & ~z_is_largest) | z_is_largest << 1;
    kx = (0b001001U >> (2 * kz)) & 3;
    ky = (0b010010U >> (2 * kz)) & 3;
    origin_d = to_double(origin);
    direction_d = to_double(cleaned(ray.direction));
    shear_xd = direction_d[kx] / direction_d[kz];
    shear_yd = direction_d[ky] / direction_d[kz];
    shear_x = static_cast<float>(shear_xd);
    shear_y = static_cast<float>(shear_yd);
  }
};

/// Where a ray crosses a primitive; see Hit for u and v.
struct Crossing {
  float t = 0, u = 0, v = 0;
};

/// Rounds t and says whether it is a hit: finite and within [t_min, limit], both included. `limit` is the nearest hit
/// so far or the ray's own end.
inline bool accept_t(const PreparedRay& ray, double t, float limit, Crossing& crossing) {
  crossing.t = without_minus_zero(static_cast<float>(t));
  return crossing.t >= ray.t_min && crossing.t <= limit && std::isfinite(crossing.t);
}

/// A point in the ray's sheared space, in double: the ray runs along z through x = y = 0.
inline Vec3d sheared(const PreparedRay& ray, Vec3d p) {
  const Vec3d q = p - ray.origin_d;
  const double z = q[ray.kz];
  return {q[ray.kx] - ray.shear_xd * z, q[ray.ky] - ray.shear_yd * z, z};
}

/// Twice the signed area of (0, p, q), seen along the ray. Swapping p and q changes exactly the sign, so that two
/// neighbours agree about the edge they share.
inline double edge(Vec3d p, Vec3d q) { return p.x * q.y - p.y * q.x; }

}  // namespace kerf
