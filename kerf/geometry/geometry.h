#pragma once

#include <span>
#include <string_view>
#include <variant>

#include "kerf/base/box3.h"
#include "kerf/geometry/clip.h"
#include "kerf/geometry/prepared_ray.h"
#include "kerf/geometry/shapes.h"

namespace kerf {

/// One kind of primitive, many of them: the unit that a caller adds to a scene. Primitives are numbered from 0 in the
/// caller's order.
struct Geometry {
  std::variant<TriangleMesh, Strided<Sphere>, Strided<Parallelogram>> shapes;
  uint32_t mask = 0xFFFFFFFFU;  ///< seen by rays whose mask shares a bit
};

/// "triangle", "sphere" or "parallelogram".
std::string_view kind_name(const Geometry& geometry);

size_t primitive_count(const Geometry& geometry);

/// The smallest float box around a primitive. The primitive must be valid.
Box3f primitive_bounds(const Geometry& geometry, uint32_t primitive);

/// The tight box, rounded outward, of what of the primitive lies in `cell`; empty where nothing does.
Box3f clipped_bounds(const Geometry& geometry, uint32_t primitive, const Box3f& cell);

/// clipped_bounds() of the two parts of `cell` on either side of a plane across it.
CutBounds cut_bounds(const Geometry& geometry, uint32_t primitive, const Box3f& cell, uint32_t axis, float position);

/// What can be wrong with a primitive; `none` also for those that are merely without area.
enum class Defect { none, bad_index, bad_coordinate, bad_radius };
Defect find_defect(const Geometry& geometry, uint32_t primitive);

/// True for a primitive without area: valid, but never hit. The primitive must be valid.
bool is_degenerate(const Geometry& geometry, uint32_t primitive);

/// Where the ray crosses a primitive first within [t_min, limit]. The one truth that every kernel agrees with.
bool intersect(const Geometry& geometry, uint32_t primitive, const PreparedRay& ray, float limit, Crossing& crossing);

/// The unit normal at a crossing: of a triangle by the right hand around its corners, of a parallelogram along u x v,
/// of a sphere outward.
Vec3f unit_normal(const Geometry& geometry, uint32_t primitive, float u, float v);

}  // namespace kerf
