#pragma once

#include "kerf/geometry/prepared_ray.h"

namespace kerf {
namespace detail {

/// A unit normal (of any length) on the octahedral map of [0, 1]^2. Only arithmetic that rounds the same everywhere,
/// which arc tangents do not.
inline void octahedral(Vec3d n, Crossing& crossing) {
  const Vec3d size = abs(n);
  const double scale = 1 / (size.x + size.y + size.z);
  double x = n.x * scale, y = n.y * scale;
  if (n.z < 0) {
    const double folded = (1 - (y < 0 ? -y : y)) * (x < 0 ? -1 : 1);
    y = (1 - (x < 0 ? -x : x)) * (y < 0 ? -1 : 1);
    x = folded;
  }
  crossing.u = static_cast<float>(0.5 * x + 0.5);
  crossing.v = static_cast<float>(0.5 * y + 0.5);
}

/// The way back: a normal, not of unit length.
inline Vec3d from_octahedral(float u, float v) {
  const double x = 2.0 * u - 1, y = 2.0 * v - 1;
  const double size_x = x < 0 ? -x : x, size_y = y < 0 ? -y : y;
  const double z = 1 - size_x - size_y;
  if (z >= 0) return {x, y, z};
  return {(1 - size_y) * (x < 0 ? -1 : 1), (1 - size_x) * (y < 0 ? -1 : 1), z};
}

}  // namespace detail

/// A sphere without surface.
inline bool is_degenerate(const Sphere& s) { return !(s.radius > 0); }

/// The first crossing of the sphere's surface within [t_min, limit]: where the ray enters, else where it leaves.
/// In double, from the point of closest approach, which keeps its digits for a distant origin.
inline bool intersect(const PreparedRay& ray, const Sphere& sphere, float limit, Crossing& crossing) {
  const Vec3d from_center = ray.origin_d - to_double(cleaned(sphere.center));
  const double length2 = dot(ray.direction_d, ray.direction_d);
  const double closest = -dot(from_center, ray.direction_d) / length2;
  const Vec3d offset = from_center + closest * ray.direction_d;
  const double radius = sphere.radius;
  const double inside = radius * radius - dot(offset, offset);
  if (!(inside >= 0) || is_degenerate(sphere)) return false;
  const double half = std::sqrt(inside / length2);
  double from_closest = -half;
  if (!accept_t(ray, closest + from_closest, limit, crossing)) {
    from_closest = half;
    if (!accept_t(ray, closest + from_closest, limit, crossing)) return false;
  }
  detail::octahedral(offset + from_closest * ray.direction_d, crossing);
  return true;
}

}  // namespace kerf
