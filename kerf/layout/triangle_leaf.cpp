#include "kerf/layout/triangle_leaf.h"

#include <variant>

#include "kerf/base/rounding.h"

namespace kerf {

void write_triangle_leaf(std::span<const LeafSlot> slots, std::span<const Geometry> geometries, LeafUnit* to) {
  const size_t count = slots.size();
  float* const data = to->values;
  Box3f box;
  for (size_t i = 0; i < count; ++i) {
    const auto& mesh = std::get<TriangleMesh>(geometries[slots[i].geometry()].shapes);
    const Triangle triangle = mesh.triangle(slots[i].primitive);
    const Vec3f corners[3] = {triangle.a, triangle.b, triangle.c};
    for (uint32_t c = 0; c < 3; ++c) {
      box.extend(corners[c]);
      for (uint32_t axis = 0; axis < 3; ++axis) data[1 + (3 * c + axis) * count + i] = corners[c][axis];
    }
  }
  const Vec3d extent = to_double(box.upper) - to_double(box.lower);
  data[0] = round_up(largest(extent));
  std::memcpy(data + 1 + 9 * count, slots.data(), count * sizeof(LeafSlot));
}

}  // namespace kerf
