#pragma once

#include <limits>

#include "kerf/base/vec3.h"

namespace kerf {

/// An axis-aligned box, closed on all sides; a default one is empty (lower above upper). 24 bytes.
struct Box3f {
  static constexpr float kInfinity = std::numeric_limits<float>::infinity();

  Vec3f lower{kInfinity, kInfinity, kInfinity};
  Vec3f upper{-kInfinity, -kInfinity, -kInfinity};

  constexpr bool is_empty() const { return lower.x > upper.x || lower.y > upper.y || lower.z > upper.z; }
  constexpr Vec3f extent() const { return upper - lower; }

  constexpr void extend(Vec3f p) {
    lower = min(lower, p);
    upper = max(upper, p);
  }
  constexpr void extend(const Box3f& b) {
    lower = min(lower, b.lower);
    upper = max(upper, b.upper);
  }
  constexpr bool contains(Vec3f p) const {
    return lower.x <= p.x && p.x <= upper.x && lower.y <= p.y && p.y <= upper.y && lower.z <= p.z && p.z <= upper.z;
  }
  constexpr bool contains(const Box3f& b) const { return b.is_empty() || (contains(b.lower) && contains(b.upper)); }

  friend constexpr bool operator==(const Box3f&, const Box3f&) = default;
};

constexpr Box3f united(Box3f a, const Box3f& b) {
  a.extend(b);
  return a;
}

constexpr Box3f intersected(const Box3f& a, const Box3f& b) { return {max(a.lower, b.lower), min(a.upper, b.upper)}; }

/// Half the surface area, in double: float overflows for coordinates that we accept. 0 for an empty box.
constexpr double half_area(const Box3f& b) {
  if (b.is_empty()) return 0;
  const Vec3d e = to_double(b.upper) - to_double(b.lower);
  return e.x * e.y + e.y * e.z + e.z * e.x;
}

/// The area of all six faces, in squared scene units.
constexpr double surface_area(const Box3f& b) { return 2 * half_area(b); }

/// The centre along one axis, between the two sides even where they are neighbouring floats.
constexpr float center(const Box3f& b, uint32_t axis) { return 0.5F * b.lower[axis] + 0.5F * b.upper[axis]; }

}  // namespace kerf
