#include "kerf/choose/slab_bounds.h"

#include <array>
#include <variant>

namespace kerf {
namespace {

/// The corners of what is bounded by straight edges, in order; none for a sphere.
struct Outline {
  std::array<Vec3f, 4> corners;
  uint32_t size = 0;
};

Outline outline_of(const Geometry& geometry, uint32_t primitive) {
  if (const auto* mesh = std::get_if<TriangleMesh>(&geometry.shapes)) {
    const Triangle triangle = mesh->triangle(primitive);
    return {{triangle.a, triangle.b, triangle.c}, 3};
  }
  if (const auto* shapes = std::get_if<Strided<Parallelogram>>(&geometry.shapes)) {
    Outline outline{{}, 4};
    const auto corners = (*shapes)[primitive].corners();
    for (uint32_t i = 0; i < 4; ++i) outline.corners[i] = to_float(corners[i]);
    return outline;
  }
  return {};
}

/// Extends the slabs `begin` to `end` that an edge runs through by its parts there.
void extend_by_edge(Vec3f from, Vec3f to, const Slabs& slabs, uint32_t begin, uint32_t end, Box3f* parts) {
  const uint32_t axis = slabs.axis;
  if (from[axis] > to[axis]) std::swap(from, to);
  const uint32_t first = slabs.slab_of(from[axis]), last = slabs.slab_of(to[axis]);
  if (first >= begin && first <= end) parts[first].extend(from);
  if (last >= begin && last <= end) parts[last].extend(to);
  const Vec3f along = (to - from) / (to[axis] - from[axis]);
  // The planes between two slabs of which one is asked for.
  const uint32_t until = std::min(last, end + 1);
  for (uint32_t i = std::max(first + 1, begin); i <= until; ++i) {
    const float position = slabs.plane(i);
    Vec3f crossing = from + along * (position - from[axis]);
    crossing[axis] = position;
    if (i > begin) parts[i - 1].extend(crossing);
    if (i <= end) parts[i].extend(crossing);
  }
}

}  // namespace

void extend_by_parts(std::span<const Geometry> geometries, const Reference& reference, const Slabs& slabs,
                     uint32_t begin, uint32_t end, Box3f* bounds) {
  const Outline outline = outline_of(geometries[reference.geometry], reference.primitive);
  Box3f parts[kMostSlabs];
  for (uint32_t i = 0; i < outline.size; ++i) {
    const Vec3f next = outline.corners[i + 1 == outline.size ? 0 : i + 1];
    extend_by_edge(outline.corners[i], next, slabs, begin, end, parts);
  }
  for (uint32_t i = begin; i <= end; ++i) {
    Box3f part = reference.bounds();
    part.lower[slabs.axis] = std::max(part.lower[slabs.axis], slabs.plane(i));
    part.upper[slabs.axis] = std::min(part.upper[slabs.axis], slabs.plane(i + 1));
    if (outline.size > 0) part = intersected(part, parts[i]);
    if (!part.is_empty()) bounds[i].extend(part);
  }
}

}  // namespace kerf
