#include "kerf/layout/triangle_leaf.h"

#include <variant>

#include "kerf/geometry/ray_triangle.h"

namespace kerf {

void write_triangle_leaf(std::span<const LeafSlot> slots, std::span<const Geometry> geometries, LeafUnit* to) {
  const size_t count = slots.size();
  float* const data = to->values;
  for (size_t i = 0; i < count; ++i) {
    const auto& mesh = std::get<TriangleMesh>(geometries[slots[i].geometry()].shapes);
    const Triangle triangle = mesh.triangle(slots[i].primitive);
    const bool is_point = is_degenerate(triangle);
    const Vec3f corners[3] = {triangle.a, is_point ? triangle.a : triangle.b, is_point ? triangle.a : triangle.c};
    for (uint32_t c = 0; c < 3; ++c) {
      for (uint32_t axis = 0; axis < 3; ++axis) data[(3 * c + axis) * count + i] = corners[c][axis];
    }
  }
  std::memcpy(data + 9 * count, slots.data(), count * sizeof(LeafSlot));
}

}  // namespace kerf
