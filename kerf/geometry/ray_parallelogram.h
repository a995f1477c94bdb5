#pragma once

#include <algorithm>

#include "kerf/geometry/prepared_ray.h"

namespace kerf {

/// True for a parallelogram without area.
inline bool is_degenerate(const Parallelogram& p) { return cross(to_double(p.u), to_double(p.v)) == Vec3d{}; }

/// Where the ray crosses a parallelogram, seen from either side; its border belongs to it. Decided in double by the
/// four edge functions of its corners, as a triangle is by three, so a mesh of both is watertight where corners are
/// equal.
inline bool intersect(const PreparedRay& ray, const Parallelogram& shape, float limit, Crossing& crossing) {
  const std::array<Vec3d, 4> corner = shape.corners();
  const Vec3d p0 = sheared(ray, corner[0]), p1 = sheared(ray, corner[1]);
  const Vec3d p2 = sheared(ray, corner[2]), p3 = sheared(ray, corner[3]);
  const double e[4] = {edge(p0, p1), edge(p1, p2), edge(p2, p3), edge(p3, p0)};
  const auto [low, high] = std::minmax({e[0], e[1], e[2], e[3]});
  if (low < 0 && high > 0) return false;
  const Vec3d u = p1 - p0, v = p3 - p0;
  const double det = edge(u, v);
  if (det == 0) return false;
  const double share_u = std::clamp(-edge(p0, v) / det, 0.0, 1.0);
  const double share_v = std::clamp(edge(p0, u) / det, 0.0, 1.0);
  const double depth = p0.z + share_u * u.z + share_v * v.z;
  if (!accept_t(ray, depth / ray.direction_d[ray.kz], limit, crossing) || is_degenerate(shape)) return false;
  crossing.u = without_minus_zero(static_cast<float>(share_u));
  crossing.v = without_minus_zero(static_cast<float>(share_v));
  return true;
}

}  // namespace kerf
