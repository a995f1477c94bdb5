#pragma once

#include <cstddef>
#include <span>

#include "kerf/geometry/geometry.h"

namespace kerf {

/// A place on a primitive that moves with its vertices: a + s (b - a) + t (c - a) on a triangle, so that s and t are
/// barycentric coordinates, corner + s u + t v on a parallelogram. A sphere's part is held by a box, three of these:
/// from s to t along x, y and z, in radii from its centre. 8 bytes.
struct FragmentCorner {
  float s = 0, t = 0;
};

/// Four corners and six cuts make ten; what rounding adds is taken as whole.
inline constexpr size_t kMaxFragmentCorners = 15;

/// The corners of what of a primitive lies in `cell`, and their number. 0 of them: the whole primitive, because all of
/// it lies there, or none does (so that nothing is ever dropped).
///
/// No point of the primitive in the cell is farther than 2^-24 from the polygon, in s and in t, however thin the
/// primitive and however it stands to the cell: the cuts are made 2^-44 of the coordinates' size outside the cell,
/// which is more than all rounding can move a corner across its plane, so it does not matter how far it moves along it;
/// across the edges that it lies on, a corner is off by 2^-48 after six cuts, and by 2^-25 once it is stored. The same
/// holds for the sides of a sphere's box, which one subtraction, one division and the rounding to float make.
size_t cut_fragment(const Geometry& geometry, uint32_t primitive, const Box3f& cell,
                    std::span<FragmentCorner, kMaxFragmentCorners> corners);

/// A box around the part of a primitive that has these corners, wherever the primitive's vertices are by now: with the
/// polygon it holds all that lies within 2^-24 of it, and no part reaches past the whole primitive's box. Without
/// corners: that box.
Box3f fragment_bounds(const Geometry& geometry, uint32_t primitive, std::span<const FragmentCorner> corners);

/// The area of such a part's surface; of a sphere's, half the area of the sphere's box.
double fragment_area(const Geometry& geometry, uint32_t primitive, std::span<const FragmentCorner> corners);

}  // namespace kerf
