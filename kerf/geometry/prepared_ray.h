#pragma once

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

  explicit PreparedRay(const Ray& ray) {
    const float length = largest(abs(ray.direction));
    valid = is_coordinate(ray.origin) && length >= 0x1p-100F && length <= 0x1p100F && ray.t_min <= ray.t_max &&
            std::isfinite(ray.direction.x) && std::isfinite(ray.direction.y) && std::isfinite(ray.direction.z);
    if (!valid) return;
    origin = cleaned(ray.origin);
    t_min = ray.t_min;
    t_max = ray.t_max;
    mask = ray.mask;
    kz = largest_axis(abs(ray.direction));
    kx = kz == 2 ? 0 : kz + 1;
    ky = kx == 2 ? 0 : kx + 1;
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
