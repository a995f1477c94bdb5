#include "kerf/geometry/fragment.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "kerf/geometry/ray_sphere.h"

namespace kerf {
namespace {

/// A flat primitive as origin + s * along_s + t * along_t.
struct Frame {
  Vec3d origin, along_s, along_t;
  bool is_triangle = true;  ///< s + t <= 1

  Vec3d at(double s, double t) const { return origin + along_s * s + along_t * t; }
  /// The size of the numbers that make a coordinate.
  Vec3d size() const { return abs(origin) + abs(along_s) + abs(along_t); }
};

/// Of a triangle or parallelogram.
Frame frame_of(const Geometry& geometry, uint32_t primitive) {
  if (const auto* mesh = std::get_if<TriangleMesh>(&geometry.shapes)) {
    const Triangle t = mesh->triangle(primitive);
    const Vec3d a = to_double(t.a);
    return {a, to_double(t.b) - a, to_double(t.c) - a, true};
  }
  const Parallelogram p = std::get<Strided<Parallelogram>>(geometry.shapes)[primitive];
  return {to_double(cleaned(p.corner)), to_double(p.u), to_double(p.v), false};
}

struct Corner {
  double s, t;
};

/// A polygon in s and t.
struct Polygon {
  std::array<Corner, kMaxFragmentCorners> corners;
  size_t size = 0;
  bool overflowed = false;

  void push(Corner corner) {
    overflowed = overflowed || size == corners.size();
    if (!overflowed) corners[size++] = corner;
  }
};

/// A plane as a function of s and t: what lies inside is not below 0.
struct Side {
  double base, by_s, by_t;

  double operator()(Corner c) const { return base + by_s * c.s + by_t * c.t; }
};

/// Cuts off what lies outside (Sutherland and Hodgman 1974, one plane) and says whether anything did.
bool keep_inside(Polygon& polygon, const Side& side) {
  std::array<double, kMaxFragmentCorners> value;
  bool all_inside = true;
  for (size_t i = 0; i < polygon.size; ++i) {
    value[i] = side(polygon.corners[i]);
    all_inside = all_inside && value[i] >= 0;
  }
  if (all_inside) return false;
  Polygon kept;
  kept.overflowed = polygon.overflowed;
  for (size_t i = 0; i < polygon.size; ++i) {
    const size_t next = i + 1 == polygon.size ? 0 : i + 1;
    const Corner p = polygon.corners[i], q = polygon.corners[next];
    if (value[i] >= 0) kept.push(p);
    if ((value[i] > 0 && value[next] < 0) || (value[i] < 0 && value[next] > 0)) {
      const double share = value[i] / (value[i] - value[next]);
      kept.push({p.s + (q.s - p.s) * share, p.t + (q.t - p.t) * share});
    }
  }
  polygon = kept;
  return true;
}

constexpr double kCutSlack = 0x1p-44;     ///< of the coordinates' size: how far outside the cell cuts are made
constexpr double kCornerError = 0x1p-24;  ///< of a stored corner, in s and in t
constexpr double kRounding = 0x1p-49;     ///< of a coordinate made from s and t, of the coordinates' size

size_t cut_fragment(const Sphere& sphere, const Box3f& cell, std::span<FragmentCorner, kMaxFragmentCorners> sides) {
  const Box3f box = clipped_bounds(sphere, cell);
  if (box.is_empty() || is_degenerate(sphere)) return 0;
  bool is_cut = false;
  for (uint32_t axis = 0; axis < 3; ++axis) {
    const double center = without_minus_zero(sphere.center[axis]), radius = sphere.radius;
    const double from = (box.lower[axis] - center) / radius, to = (box.upper[axis] - center) / radius;
    is_cut = is_cut || from > -1 || to < 1;
    sides[axis] = {static_cast<float>(std::max(from, -1.0)), static_cast<float>(std::min(to, 1.0))};
  }
  return is_cut ? 3 : 0;
}

size_t cut_fragment(const Frame& frame, const Box3f& cell, std::span<FragmentCorner, kMaxFragmentCorners> corners) {
  Polygon polygon;
  polygon.push({0, 0});
  polygon.push({1, 0});
  if (!frame.is_triangle) polygon.push({1, 1});
  polygon.push({0, 1});
  const Vec3d slack = kCutSlack * frame.size();
  bool is_cut = false;
  for (uint32_t axis = 0; axis < 3; ++axis) {
    const double origin = frame.origin[axis], by_s = frame.along_s[axis], by_t = frame.along_t[axis];
    const Side above_lower{origin - (cell.lower[axis] - slack[axis]), by_s, by_t};
    const Side below_upper{cell.upper[axis] + slack[axis] - origin, -by_s, -by_t};
    is_cut = keep_inside(polygon, above_lower) || is_cut;
    is_cut = keep_inside(polygon, below_upper) || is_cut;
  }
  if (!is_cut || polygon.overflowed) return 0;
  for (size_t i = 0; i < polygon.size; ++i) {
    corners[i] = {static_cast<float>(polygon.corners[i].s), static_cast<float>(polygon.corners[i].t)};
  }
  return polygon.size;
}

Box3f bounds_of(const Sphere& sphere, std::span<const FragmentCorner> sides) {
  const Vec3d center = to_double(cleaned(sphere.center));
  const double radius = sphere.radius;
  Vec3d lower, upper;
  for (uint32_t axis = 0; axis < 3; ++axis) {
    const double slack = kCornerError * radius + kRounding * (std::abs(center[axis]) + radius);
    lower[axis] = center[axis] + radius * sides[axis].s - slack;
    upper[axis] = center[axis] + radius * sides[axis].t + slack;
  }
  return outward(lower, upper);
}

Box3f bounds_of(const Frame& frame, std::span<const FragmentCorner> corners) {
  Vec3d lower = frame.at(corners[0].s, corners[0].t), upper = lower;
  for (const FragmentCorner& corner : corners.subspan(1)) {
    const Vec3d p = frame.at(corner.s, corner.t);
    lower = min(lower, p);
    upper = max(upper, p);
  }
  const Vec3d slack = kCornerError * (abs(frame.along_s) + abs(frame.along_t)) + kRounding * frame.size();
  return outward(lower - slack, upper + slack);
}

}  // namespace

size_t cut_fragment(const Geometry& geometry, uint32_t primitive, const Box3f& cell,
                    std::span<FragmentCorner, kMaxFragmentCorners> corners) {
  const auto* spheres = std::get_if<Strided<Sphere>>(&geometry.shapes);
  return spheres != nullptr ? cut_fragment((*spheres)[primitive], cell, corners)
                            : cut_fragment(frame_of(geometry, primitive), cell, corners);
}

Box3f fragment_bounds(const Geometry& geometry, uint32_t primitive, std::span<const FragmentCorner> corners) {
  const Box3f whole = primitive_bounds(geometry, primitive);
  if (corners.empty()) return whole;
  const auto* spheres = std::get_if<Strided<Sphere>>(&geometry.shapes);
  const Box3f box = spheres != nullptr ? bounds_of((*spheres)[primitive], corners)
                                       : bounds_of(frame_of(geometry, primitive), corners);
  return intersected(box, whole);
}

double fragment_area(const Geometry& geometry, uint32_t primitive, std::span<const FragmentCorner> corners) {
  if (std::holds_alternative<Strided<Sphere>>(geometry.shapes)) return half_area(primitive_bounds(geometry, primitive));
  const Frame frame = frame_of(geometry, primitive);
  double twice = frame.is_triangle ? 1 : 2;  // the area in s and t
  if (!corners.empty()) twice = 0;
  for (size_t i = 0; i < corners.size(); ++i) {
    const FragmentCorner p = corners[i], q = corners[i + 1 == corners.size() ? 0 : i + 1];
    twice += static_cast<double>(p.s) * q.t - static_cast<double>(q.s) * p.t;
  }
  const Vec3d normal = cross(frame.along_s, frame.along_t);
  return 0.5 * std::abs(twice) * std::sqrt(dot(normal, normal));
}

}  // namespace kerf
