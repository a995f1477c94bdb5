#pragma once

#include <algorithm>

#include "kerf/geometry/prepared_ray.h"

namespace kerf {
namespace detail {

/// False if the ray surely passes outside, judged in float with a bound on the error of the three edge functions; true
/// if it may hit. With s the largest sheared coordinate and z the largest depth, a sheared coordinate is off by at most
/// 6 e (s + z) and an edge function by at most 30 e s (s + z), e = 2^-24; the bound used is 32 e s (s + z), and 2^-120
/// covers underflow. Overflow gives NaN, which counts as "may".
inline bool may_hit_triangle(const PreparedRay& ray, const Triangle& t) {
  const Vec3f a = t.a - ray.origin, b = t.b - ray.origin, c = t.c - ray.origin;
  const float az = a[ray.kz], bz = b[ray.kz], cz = c[ray.kz];
  const float ax = a[ray.kx] - ray.shear_x * az, ay = a[ray.ky] - ray.shear_y * az;
  const float bx = b[ray.kx] - ray.shear_x * bz, by = b[ray.ky] - ray.shear_y * bz;
  const float cx = c[ray.kx] - ray.shear_x * cz, cy = c[ray.ky] - ray.shear_y * cz;
  const float u = cx * by - cy * bx, v = ax * cy - ay * cx, w = bx * ay - by * ax;
  const auto max3 = [](float p, float q, float r) { return std::max(std::max(p, q), r); };
  const float s =
      std::max(max3(std::abs(ax), std::abs(bx), std::abs(cx)), max3(std::abs(ay), std::abs(by), std::abs(cy)));
  const float z = max3(std::abs(az), std::abs(bz), std::abs(cz));
  const float error = 0x1p-19F * (s * (s + z)) + 0x1p-120F;
  return !(std::min(std::min(u, v), w) < -error && max3(u, v, w) > error);
}

}  // namespace detail

/// True for a triangle without area, judged without rounding (unless magnitudes differ by more than 2^29).
inline bool is_degenerate(const Triangle& t) {
  const Vec3d a = to_double(t.a);
  return cross(to_double(t.b) - a, to_double(t.c) - a) == Vec3d{};
}

namespace detail {

/// intersect() for a triangle with an area that the ray may hit. One division decides.
inline bool intersect_exactly(const PreparedRay& ray, const Triangle& triangle, float limit, Crossing& crossing) {
  const Vec3d a = sheared(ray, to_double(triangle.a));
  const Vec3d b = sheared(ray, to_double(triangle.b));
  const Vec3d c = sheared(ray, to_double(triangle.c));
  const double u = edge(c, b), v = edge(a, c), w = edge(b, a);
  if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return false;
  const double det = u + v + w;
  if (det == 0) return false;
  const double t = (u * a.z + v * b.z + w * c.z) / (det * ray.direction_d[ray.kz]);
  if (!accept_t(ray, t, limit, crossing)) return false;
  crossing.u = without_minus_zero(static_cast<float>(v / det));
  crossing.v = without_minus_zero(static_cast<float>(w / det));
  return true;
}

}  // namespace detail

/// Where the ray crosses a triangle, seen from either side; edges and corners belong to it. `limit` is the largest t of
/// interest. Watertight after Woop, Benthin, Wald 2013, with the decision in double: there a triangle's edge functions
/// have the right sign or are 0, and 0 is inside, so no ray slips between neighbours; t, u and v are right to about one
/// rounding to float even for slivers and at grazing angles. A triangle without area is never hit.
inline bool intersect(const PreparedRay& ray, const Triangle& triangle, float limit, Crossing& crossing) {
  return detail::may_hit_triangle(ray, triangle) && detail::intersect_exactly(ray, triangle, limit, crossing) &&
         !is_degenerate(triangle);
}

}  // namespace kerf
