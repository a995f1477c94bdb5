// Rays against triangles, parallelograms and spheres in long double, by other methods than the library's: what its
// scalar tests are judged by.

#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "kerf/base/box3.h"
#include "kerf/geometry/ray.h"
#include "kerf/geometry/shapes.h"

namespace kerf::test {

using Real = long double;
using Vec3r = Vec3<Real>;

inline constexpr Real kRealInfinity = std::numeric_limits<Real>::infinity();

constexpr Vec3r to_real(Vec3f p) { return {p.x, p.y, p.z}; }
constexpr Vec3r to_real(Vec3d p) { return {p.x, p.y, p.z}; }
inline Real length(Vec3r v) { return std::sqrt(dot(v, v)); }

/// The scalar triple product: six times the signed volume of the tetrahedron that p, q and r span.
constexpr Real volume(Vec3r p, Vec3r q, Vec3r r) { return dot(p, cross(q, r)); }

/// Where a ray's line crosses the plane of a convex polygon, and how far inside the polygon that is.
struct ExactCrossing {
  Real t = kRealInfinity;
  Real u = 0, v = 0;
  /// The distance from the ray's line to the nearest edge's line, negative where it passes outside. Along the ray both
  /// are the same point, so this is what rounding of positions can turn over.
  Real margin = -kRealInfinity;
  Real reach = 0;  ///< the distance of the farthest corner from the origin: what positions are rounded relative to
  Real width = 0;  ///< of the polygon as the ray sees it: twice its area over its longest side
  bool is_parallel = true;
};

/// For three or four corners in order around a flat convex polygon. u belongs to the second corner and v to the last:
/// their weights in a triangle, the shares of the two sides in a parallelogram.
inline ExactCrossing cross_exactly(std::span<const Vec3r> corners, const Ray& ray) {
  const Vec3r origin = to_real(cleaned(ray.origin)), direction = to_real(ray.direction);
  std::array<Vec3r, 4> corner;
  ExactCrossing result;
  const size_t count = corners.size();
  for (size_t i = 0; i < count; ++i) {
    corner[i] = corners[i] - origin;
    result.reach = std::max(result.reach, length(corner[i]));
  }
  const Vec3r second = corner[1] - corner[0], last = corner[count - 1] - corner[0];
  const Real whole = volume(direction, second, last);
  if (whole == 0) return result;
  result.is_parallel = false;
  result.t = volume(corner[0], second, last) / whole;
  result.u = volume(direction, last, corner[0]) / whole;
  result.v = volume(direction, corner[0], second) / whole;
  result.margin = kRealInfinity;
  Real longest = 0;
  for (size_t i = 0; i < count; ++i) {
    const Vec3r from = corner[i], side = corner[(i + 1) % count] - from;
    const Real seen = length(cross(direction, side));  // the side's length as the ray sees it, times that of direction
    longest = std::max(longest, seen);
    const Real inside = volume(direction, from, side) * (whole > 0 ? 1 : -1);
    result.margin = std::min(result.margin, seen > 0 ? inside / seen : -kRealInfinity);
  }
  result.width = std::abs(whole) / longest;
  return result;
}

inline ExactCrossing cross_exactly(const Triangle& t, const Ray& ray) {
  return cross_exactly(std::array{to_real(t.a), to_real(t.b), to_real(t.c)}, ray);
}

inline ExactCrossing cross_exactly(const Parallelogram& p, const Ray& ray) {
  const Vec3r a = to_real(p.corner), u = to_real(p.u), v = to_real(p.v);
  return cross_exactly(std::array{a, a + u, a + u + v, a + v}, ray);
}

/// Where a ray's line enters and leaves a sphere: the roots of the plain quadratic. 64 bits hide its cancellation as
/// long as the origin is not some thousand radii away.
struct ExactSphere {
  Real enter = kRealInfinity, leave = kRealInfinity;
  Real margin = 0;  ///< radius minus the distance between line and centre; negative: they do not meet
};

inline ExactSphere cross_exactly(const Sphere& sphere, const Ray& ray) {
  const Vec3r offset = to_real(ray.origin) - to_real(sphere.center), direction = to_real(ray.direction);
  const Real a = dot(direction, direction), b = dot(offset, direction);
  const Real c = dot(offset, offset) - Real{sphere.radius} * sphere.radius;
  ExactSphere result;
  result.margin = sphere.radius - length(cross(offset, direction)) / std::sqrt(a);
  const Real discriminant = b * b - a * c;
  if (discriminant < 0) return result;
  const Real root = std::sqrt(discriminant);
  result.enter = (-b - root) / a;
  result.leave = (-b + root) / a;
  return result;
}

/// The smallest and largest coordinates of some points; empty where there are none.
struct ExactBox {
  Vec3r lower{kRealInfinity, kRealInfinity, kRealInfinity};
  Vec3r upper{-kRealInfinity, -kRealInfinity, -kRealInfinity};

  bool is_empty() const { return lower.x > upper.x; }
  void extend(Vec3r p) {
    lower = min(lower, p);
    upper = max(upper, p);
  }
};

inline bool is_inside(const Box3f& cell, Vec3r p) {
  for (uint32_t axis = 0; axis < 3; ++axis) {
    if (p[axis] < cell.lower[axis] || p[axis] > cell.upper[axis]) return false;
  }
  return true;
}

/// The corners of a flat convex polygon's part in a cell, each straight from the polygon and the cell: corners of the
/// polygon, its sides against the cell's faces, and the cell's edges against its inside.
template <class F>
void for_each_clipped_corner(std::span<const Vec3r> polygon, const Box3f& cell, F&& f) {
  const size_t count = polygon.size();
  const Vec3r normal = cross(polygon[1] - polygon[0], polygon[count - 1] - polygon[0]);
  for (size_t i = 0; i < count; ++i) {
    const Vec3r p = polygon[i], q = polygon[(i + 1) % count];
    if (is_inside(cell, p)) f(p);
    for (uint32_t face = 0; face < 6; ++face) {
      const uint32_t axis = face % 3;
      const Real plane = face < 3 ? cell.lower[axis] : cell.upper[axis];
      if ((p[axis] < plane) == (q[axis] < plane) || q[axis] == plane || p[axis] == plane) continue;
      Vec3r cut = p + (q - p) * ((plane - p[axis]) / (q[axis] - p[axis]));
      cut[axis] = plane;
      if (is_inside(cell, cut)) f(cut);
    }
  }
  for (uint32_t line = 0; line < 12; ++line) {
    const uint32_t axis = line % 3, b = (axis + 1) % 3, c = (axis + 2) % 3;
    if (normal[axis] == 0) continue;
    Vec3r cut;
    cut[b] = (line / 3) % 2 == 0 ? cell.lower[b] : cell.upper[b];
    cut[c] = line / 6 == 0 ? cell.lower[c] : cell.upper[c];
    const Vec3r& p = polygon[0];
    cut[axis] = p[axis] - (normal[b] * (cut[b] - p[b]) + normal[c] * (cut[c] - p[c])) / normal[axis];
    bool left = true, right = true;
    for (size_t i = 0; i < count; ++i) {
      const Vec3r from = polygon[i], side = polygon[(i + 1) % count] - from;
      const Real turn = side[b] * (cut[c] - from[c]) - side[c] * (cut[b] - from[b]);
      left = left && turn >= 0;
      right = right && turn <= 0;
    }
    if ((left || right) && is_inside(cell, cut)) f(cut);
  }
}

inline ExactBox clip_exactly(std::span<const Vec3r> polygon, const Box3f& cell) {
  ExactBox box;
  for_each_clipped_corner(polygon, cell, [&](Vec3r p) { box.extend(p); });
  return box;
}

/// The box of a sphere's surface in a cell: its extremes are poles, extremes of the circles in the cell's faces, or
/// points on the cell's edges.
inline ExactBox clip_exactly(const Sphere& sphere, const Box3f& cell) {
  const Vec3r center = to_real(sphere.center);
  const Real radius2 = Real{sphere.radius} * sphere.radius;
  ExactBox box;
  const auto offer = [&](uint32_t axis, Vec3r middle, Real square) {
    for (const int sign : {-1, 1}) {
      if (square < 0) return;
      Vec3r p = middle;
      p[axis] += sign * std::sqrt(square);
      if (is_inside(cell, p)) box.extend(p);
    }
  };
  for (uint32_t axis = 0; axis < 3; ++axis) {
    const uint32_t b = (axis + 1) % 3, c = (axis + 2) % 3;
    offer(axis, center, radius2);
    for (int i = 0; i < 4; ++i) {
      Vec3r middle = center;
      const uint32_t face = i < 2 ? b : c;
      middle[face] = i % 2 == 0 ? cell.lower[face] : cell.upper[face];
      const Real off = middle[face] - center[face];
      offer(axis, middle, radius2 - off * off);
      middle[b] = i % 2 == 0 ? cell.lower[b] : cell.upper[b];
      middle[c] = i < 2 ? cell.lower[c] : cell.upper[c];
      const Real off_b = middle[b] - center[b], off_c = middle[c] - center[c];
      offer(axis, middle, radius2 - off_b * off_b - off_c * off_c);
    }
  }
  return box;
}

}  // namespace kerf::test
