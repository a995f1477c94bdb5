#include "kerf/geometry/clip.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace kerf {
namespace {

/// A corner of the polygon while it is cut, and how far it may be off along any axis: 0 for one that was there. Without
/// initial values, because arrays of it are made for every cut.
struct Corner {
  double point[3];
  double error;
};

/// Six cuts let a polygon of four corners grow to ten; rounding that dents it can at most double that again.
struct Polygon {
  static constexpr size_t kCapacity = 48;

  size_t size = 0;
  Corner corners[kCapacity];

  bool overflowed = false;

  void push(const Corner& corner) {
    overflowed = overflowed || size == kCapacity;
    if (!overflowed) corners[size++] = corner;
  }
};

/// Where an edge crosses a plane that it hardly leans against, a small error of its ends moves the crossing far along
/// it, though never past them.
Corner cut_edge(const Corner& p, const Corner& q, uint32_t axis, double position, double rounding) {
  const double across = q.point[axis] - p.point[axis];
  const double share = (position - p.point[axis]) / across;
  const double share_error = std::min(1.0, (p.error + q.error) / std::abs(across));
  Corner cut;
  double longest = 0;
  for (uint32_t i = 0; i < 3; ++i) {
    const double along = q.point[i] - p.point[i];
    cut.point[i] = p.point[i] + along * share;
    longest = std::max(longest, std::abs(along));
  }
  cut.point[axis] = position;
  cut.error = std::max(p.error, q.error) + longest * share_error + rounding;
  return cut;
}

/// Keeps the side of the plane where sign * (x - position) >= 0 (Sutherland and Hodgman 1974, one plane), and corners
/// that may lie there.
void keep_side(const Polygon& from, Polygon& to, uint32_t axis, double position, double sign, double rounding) {
  to.size = 0;
  for (size_t i = 0; i < from.size; ++i) {
    const Corner& p = from.corners[i];
    const Corner& q = from.corners[i + 1 == from.size ? 0 : i + 1];
    const double p_side = sign * (p.point[axis] - position), q_side = sign * (q.point[axis] - position);
    if (p_side >= -p.error) to.push(p);
    if ((p_side > 0 && q_side < 0) || (p_side < 0 && q_side > 0)) {
      to.push(cut_edge(p, q, axis, position, rounding));
    }
  }
}

}  // namespace

Box3f clipped_bounds(std::span<const Vec3d> polygon, const Box3f& cell) {
  Polygon buffers[2];
  Polygon *current = &buffers[0], *next = &buffers[1];
  Vec3d lower = polygon[0], upper = polygon[0];
  for (const Vec3d& p : polygon) {
    current->push({{p.x, p.y, p.z}, 0});
    lower = min(lower, p);
    upper = max(upper, p);
  }
  const double rounding = 0x1p-51 * largest(max(abs(lower), abs(upper)));  // of one cut
  for (uint32_t axis = 0; axis < 3; ++axis) {
    if (lower[axis] < cell.lower[axis]) {
      keep_side(*current, *next, axis, cell.lower[axis], 1, rounding);
      std::swap(current, next);
    }
    if (upper[axis] > cell.upper[axis]) {
      keep_side(*current, *next, axis, cell.upper[axis], -1, rounding);
      std::swap(current, next);
    }
  }
  if (buffers[0].overflowed || buffers[1].overflowed) {  // never seen; the whole cell is safe
    return intersected(outward(lower, upper), cell);
  }
  if (current->size == 0) return {};
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Vec3d whole_lower = lower, whole_upper = upper;
  lower = {kInfinity, kInfinity, kInfinity};
  upper = -lower;
  for (const Corner& corner : std::span(current->corners, current->size)) {
    for (uint32_t axis = 0; axis < 3; ++axis) {
      lower[axis] = std::min(lower[axis], corner.point[axis] - corner.error);
      upper[axis] = std::max(upper[axis], corner.point[axis] + corner.error);
    }
  }
  // No part reaches past the whole, so the allowance must not either: flat stays flat.
  const Box3f bounds = intersected(outward(max(lower, whole_lower), min(upper, whole_upper)), cell);
  return bounds.is_empty() ? Box3f{} : bounds;
}

Box3f clipped_bounds(const Sphere& sphere, const Box3f& cell) {
  const Vec3d center = to_double(cleaned(sphere.center));
  const double radius2 = static_cast<double>(sphere.radius) * sphere.radius;
  Vec3d nearest2, farthest2;  // squared distances from the centre along each axis, over the cell
  for (uint32_t axis = 0; axis < 3; ++axis) {
    const double below = cell.lower[axis] - center[axis], above = cell.upper[axis] - center[axis];
    const double near = below > 0 ? below : above < 0 ? -above : 0;
    const double far = std::max(-below, above);
    nearest2[axis] = near * near;
    farthest2[axis] = far * far;
  }
  const double slack = 0x1p-48 * (largest(abs(center)) + sphere.radius);
  Vec3d lower, upper;
  for (uint32_t axis = 0; axis < 3; ++axis) {
    const uint32_t b = (axis + 1) % 3, c = (axis + 2) % 3;
    // On the surface |x - center|^2 = r^2 - (the other two)^2, which takes every value between these ends.
    const double most2 = radius2 - nearest2[b] - nearest2[c];
    if (most2 < -slack * sphere.radius) return {};
    const double least2 = radius2 - farthest2[b] - farthest2[c];
    // Near 0 the root magnifies the rounding of its argument, so the slack goes in before it too.
    const double most = std::sqrt(std::max(most2 + slack * sphere.radius, 0.0)) + slack;
    const double least = std::sqrt(std::max(least2 - slack * sphere.radius, 0.0)) - slack;
    const double below = cell.lower[axis] - center[axis], above = cell.upper[axis] - center[axis];
    // The surface takes [-most, -least] and [least, most] along this axis; the cell [below, above].
    const bool left = below <= -least && above >= -most;
    const bool right = below <= most && above >= least;
    if (!left && !right) return {};
    lower[axis] = center[axis] + (left ? std::max(below, -most) : std::max(below, least)) - slack;
    upper[axis] = center[axis] + (right ? std::min(above, most) : std::min(above, -least)) + slack;
  }
  const Box3f bounds = intersected(outward(lower, upper), cell);
  return bounds.is_empty() ? Box3f{} : bounds;
}

}  // namespace kerf
