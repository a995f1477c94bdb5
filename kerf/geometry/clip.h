#pragma once

#include <span>

#include "kerf/base/box3.h"
#include "kerf/base/rounding.h"
#include "kerf/geometry/shapes.h"

namespace kerf {

/// The smallest float box that holds a box in double.
constexpr Box3f outward(Vec3d lower, Vec3d upper) {
  return {{round_down(lower.x), round_down(lower.y), round_down(lower.z)},
          {round_up(upper.x), round_up(upper.y), round_up(upper.z)}};
}

/// The tight box of the part of a convex polygon (three or four corners) that lies in `cell`, rounded outward and
/// within the cell; empty if they do not touch. Always cut from the polygon given, so that errors do not add up.
Box3f clipped_bounds(std::span<const Vec3d> polygon, const Box3f& cell);

/// The boxes of both sides of a plane; a side that is not reached is empty.
struct CutBounds {
  Box3f below, above;
};

/// clipped_bounds() of the two parts of `cell` on either side of a plane across it, at half the cost.
CutBounds cut_bounds(std::span<const Vec3d> polygon, const Box3f& cell, uint32_t axis, float position);

/// The tight box of the part of a sphere's surface that lies in `cell`, rounded outward and within the cell; empty if
/// the surface does not reach it, be the cell outside or inside.
Box3f clipped_bounds(const Sphere& sphere, const Box3f& cell);

}  // namespace kerf
