#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "kerf/base/vec3.h"

namespace kerf {

inline Vec3f normalized(Vec3f v) { return v / std::sqrt(dot(v, v)); }
inline Vec3d normalized(Vec3d v) { return v / std::sqrt(dot(v, v)); }

/// Three directions at right angles, of which `z` is given (Duff et al. 2017, "Building an Orthonormal Basis,
/// Revisited").
struct Frame {
  Vec3f x, y, z;

  explicit Frame(Vec3f normal) : z(normal) {
    const float sign = std::copysign(1.0F, z.z);
    const float a = -1 / (sign + z.z), b = z.x * z.y * a;
    x = {1 + sign * z.x * z.x * a, sign * b, -sign * z.x};
    y = {b, sign + z.y * z.y * a, -z.y};
  }

  Vec3f to_local(Vec3f v) const { return {dot(v, x), dot(v, y), dot(v, z)}; }
  Vec3f to_world(Vec3f v) const { return x * v.x + y * v.y + z * v.z; }
};

/// A point of the unit disk, uniform for a uniform point of the unit square, neighbours to neighbours (Shirley and Chiu
/// 1997).
inline std::array<float, 2> disk_point(std::array<float, 2> u) {
  const float a = 2 * u[0] - 1, b = 2 * u[1] - 1;
  if (a == 0 && b == 0) return {0, 0};
  constexpr float kQuarter = std::numbers::pi_v<float> / 4;
  const bool is_wide = std::abs(a) > std::abs(b);
  const float radius = is_wide ? a : b, angle = is_wide ? kQuarter * (b / a) : 2 * kQuarter - kQuarter * (a / b);
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

/// A direction about +z, distributed as its cosine with z; the density is z / pi.
inline Vec3f cosine_direction(std::array<float, 2> u) {
  const auto [x, y] = disk_point(u);
  return {x, y, std::sqrt(std::max(0.0F, 1 - x * x - y * y))};
}

}  // namespace kerf
