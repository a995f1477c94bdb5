#include "kerf/layout/triangle_leaf.h"

#include <bit>
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

void write_slots(std::span<const LeafSlot> slots, LeafUnit* to) {
  to->values[0] = std::bit_cast<float>(static_cast<uint32_t>(slots.size()));
  std::memcpy(to + 1, slots.data(), slots.size_bytes());
}

void read_slots(const LeafUnit* from, std::vector<LeafSlot>& to) {
  to.resize(std::bit_cast<uint32_t>(from->values[0]));
  std::memcpy(static_cast<void*>(to.data()), from + 1, to.size() * sizeof(LeafSlot));
}

}  // namespace kerf
