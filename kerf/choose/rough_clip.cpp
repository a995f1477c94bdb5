#include "kerf/choose/rough_clip.h"

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

}  // namespace

Clipper rough_clipper(const std::span<const Geometry>& geometries) {
  return {[](const void* data, const Reference& reference, uint32_t axis, float position) {
            const Geometry& geometry = (*static_cast<const std::span<const Geometry>*>(data))[reference.geometry];
            const auto* mesh = std::get_if<TriangleMesh>(&geometry.shapes);
            if (mesh != nullptr) return halves(mesh->triangle(reference.primitive), reference.bounds(), axis, position);
            return cut_bounds(geometry, reference.primitive, reference.bounds(), axis, position);
          },
          &geometries};
}

}  // namespace kerf
