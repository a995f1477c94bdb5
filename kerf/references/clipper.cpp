#include "kerf/references/clipper.h"

#include <algorithm>
#include <variant>

#include "kerf/references/box4.h"

namespace kerf {
namespace {

Float4 in_register(Vec3f p) { return Float4{p.x, p.y, p.z, 0}; }

ClippedBoxes halves(const Triangle& triangle, const Reference& cell, uint32_t axis, float position) {
  const Float4 corners[] = {in_register(triangle.a), in_register(triangle.b), in_register(triangle.c)};
  const float sides[] = {triangle.a[axis] - position, triangle.b[axis] - position, triangle.c[axis] - position};
  Box4 below = Box4::empty(), above = below;
  for (uint32_t i = 0; i < 3; ++i) {
    const uint32_t next = i == 2 ? 0 : i + 1;
    const float side = sides[i], next_side = sides[next];
    if (side <= 0) below.extend({corners[i], corners[i]});
    if (side >= 0) above.extend({corners[i], corners[i]});
    if (!(side < 0 && next_side > 0) && !(side > 0 && next_side < 0)) continue;
    const Float4 crossing = corners[i] + (corners[next] - corners[i]) * (side / (side - next_side));
    below.extend({crossing, crossing});
    above.extend({crossing, crossing});
  }
  const Box4 limits = Box4::of(cell);
  ClippedBoxes parts{below.intersected(limits).box(), above.intersected(limits).box()};
  parts.below.upper[axis] = std::min(parts.below.upper[axis], position);
  parts.above.lower[axis] = std::max(parts.above.lower[axis], position);
  return parts;
}

/// The span of geometries that a clipper works on.
const std::span<const Geometry>& geometries_of(const void* data) {
  return *static_cast<const std::span<const Geometry>*>(data);
}

ClippedBoxes cut(const void* data, const Reference& reference, uint32_t axis, float position) {
  return cut_bounds(geometries_of(data)[reference.geometry], reference.primitive, reference.bounds(), axis, position);
}

ClippedBoxes cut_roughly(const void* data, const Reference& reference, uint32_t axis, float position) {
  const Geometry& geometry = geometries_of(data)[reference.geometry];
  const auto* mesh = std::get_if<TriangleMesh>(&geometry.shapes);
  if (mesh == nullptr) return cut(data, reference, axis, position);
  return halves(mesh->triangle(reference.primitive), reference, axis, position);
}

}  // namespace

Clipper geometry_clipper(const std::span<const Geometry>& geometries) { return {cut, &geometries, cut_roughly}; }

Clipper rough_clipper(const std::span<const Geometry>& geometries) { return {cut_roughly, &geometries}; }

}  // namespace kerf
