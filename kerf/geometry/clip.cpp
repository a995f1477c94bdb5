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

/// What corners reach, allowances included.
struct Reach {
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double lower[3] = {kInfinity, kInfinity, kInfinity}, upper[3] = {-kInfinity, -kInfinity, -kInfinity};

  void add(const Corner& corner) {
    for (uint32_t axis = 0; axis < 3; ++axis) {
      lower[axis] = std::min(lower[axis], corner.point[axis] - corner.error);
      upper[axis] = std::max(upper[axis], corner.point[axis] + corner.error);
    }
  }
};

/// A polygon on its way through cuts, each of the polygon as it was given.
class PolygonCut {
 public:
  explicit PolygonCut(std::span<const Vec3d> polygon) : lower_(polygon[0]), upper_(polygon[0]) {
    for (const Vec3d& p : polygon) {
      current_->push({{p.x, p.y, p.z}, 0});
      lower_ = min(lower_, p);
      upper_ = max(upper_, p);
    }
    rounding_ = 0x1p-51 * largest(max(abs(lower_), abs(upper_)));
  }

  /// Cuts off what lies outside. Sides that nothing reaches past any more cost nothing: a piece's tight box has six,
  /// and one or two of them were cuts.
  void keep_inside(const Box3f& cell) {
    Vec3d lower = lower_, upper = upper_;
    for (uint32_t axis = 0; axis < 3; ++axis) {
      if (lower[axis] < cell.lower[axis]) {
        keep(axis, cell.lower[axis], 1, lower, upper);
      }
      if (upper[axis] > cell.upper[axis]) {
        keep(axis, cell.upper[axis], -1, lower, upper);
      }
    }
  }

  /// The box of what is left.
  Box3f bounds(const Box3f& cell) const {
    Reach reach;
    for (const Corner& corner : corners()) reach.add(corner);
    return box_of(reach, cell);
  }

  /// The boxes of what is left on both sides of a plane.
  CutBounds halves(const Box3f& cell, uint32_t axis, float position) const {
    CutBounds cells{cell, cell};
    cells.below.upper[axis] = position;
    cells.above.lower[axis] = position;
    Reach below, above;
    const std::span<const Corner> all = corners();
    for (size_t i = 0; i < all.size(); ++i) {
      const Corner &p = all[i], &q = all[i + 1 == all.size() ? 0 : i + 1];
      const double p_side = p.point[axis] - position, q_side = q.point[axis] - position;
      if (p_side <= p.error) below.add(p);
      if (p_side >= -p.error) above.add(p);
      if ((p_side > 0 && q_side < 0) || (p_side < 0 && q_side > 0)) {
        const Corner cut = cut_edge(p, q, axis, position, rounding_);
        below.add(cut);
        above.add(cut);
      }
    }
    return {box_of(below, cells.below), box_of(above, cells.above)};
  }

 private:
  std::span<const Corner> corners() const { return {current_->corners, current_->size}; }

  void keep(uint32_t axis, double position, double sign, Vec3d& lower, Vec3d& upper) {
    keep_side(*current_, *next_, axis, position, sign, rounding_);
    std::swap(current_, next_);
    if (current_->size == 0) return;
    lower = upper = {current_->corners[0].point[0], current_->corners[0].point[1], current_->corners[0].point[2]};
    for (const Corner& corner : corners()) {
      for (uint32_t i = 0; i < 3; ++i) {
        lower[i] = std::min(lower[i], corner.point[i]);
        upper[i] = std::max(upper[i], corner.point[i]);
      }
    }
  }

  Box3f box_of(const Reach& reach, const Box3f& cell) const {
    // Never seen; the whole cell is safe.
    if (buffers_[0].overflowed || buffers_[1].overflowed) return intersected(outward(lower_, upper_), cell);
    if (reach.lower[0] > reach.upper[0]) return {};
    // No part reaches past the whole, so the allowance must not either: flat stays flat.
    const Vec3d lower{reach.lower[0], reach.lower[1], reach.lower[2]},
        upper{reach.upper[0], reach.upper[1], reach.upper[2]};
    const Box3f box = intersected(outward(max(lower, lower_), min(upper, upper_)), cell);
    return box.is_empty() ? Box3f{} : box;
  }

  Polygon buffers_[2];
  Polygon *current_ = &buffers_[0], *next_ = &buffers_[1];
  Vec3d lower_, upper_;  ///< of the polygon as it was given
  double rounding_ = 0;  ///< of one cut
};

}  // namespace

Box3f clipped_bounds(std::span<const Vec3d> polygon, const Box3f& cell) {
  PolygonCut cut(polygon);
  cut.keep_inside(cell);
  return cut.bounds(cell);
}

CutBounds cut_bounds(std::span<const Vec3d> polygon, const Box3f& cell, uint32_t axis, float position) {
  PolygonCut cut(polygon);
  cut.keep_inside(cell);
  return cut.halves(cell, axis, position);
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
