#include "kerf/references/clipper.h"

#include <variant>

namespace kerf {
namespace {

ClippedBoxes halves(const Triangle& triangle, const Box3f& cell, uint32_t axis, float position) {
  const Vec3f corners[] = {triangle.a, triangle.b, triangle.c};
  ClippedBoxes parts;
  for (uint32_t i = 0; i < 3; ++i) {
    const Vec3f from = corners[i], to = corners[i == 2 ? 0 : i + 1];
    const float from_side = from[axis] - position, to_side = to[axis] - position;
    if (from_side <= 0) parts.below.extend(from);
    if (from_side >= 0) parts.above.extend(from);
    if (!(from_side < 0 && to_side > 0) && !(from_side > 0 && to_side < 0)) continue;
    const Vec3f crossing = from + (to - from) * (from_side / (from_side - to_side));
    parts.below.extend(crossing);
    parts.above.extend(crossing);
  }
  parts.below = intersected(parts.below, cell);
  parts.above = intersected(parts.above, cell);
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
  return halves(mesh->triangle(reference.primitive), reference.bounds(), axis, position);
}

}  // namespace

Clipper geometry_clipper(const std::span<const Geometry>& geometries) { return {cut, &geometries, cut_roughly}; }

Clipper rough_clipper(const std::span<const Geometry>& geometries) { return {cut_roughly, &geometries}; }

}  // namespace kerf
