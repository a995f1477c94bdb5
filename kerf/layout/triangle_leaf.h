#pragma once

#include <cstdint>
#include <cstring>

#include "kerf/geometry/geometry.h"
#include "kerf/tree/bvh.h"

namespace kerf {

/// What leaves consist of: 16 bytes.
struct alignas(16) LeafUnit {
  float values[4];

  const float* floats() const { return values; }
};
static_assert(sizeof(LeafUnit) == 16);

/// Up to eight triangles as kernels read them, without a gap: nine columns of `count` floats, x, y and z of the first
/// corners, of the second, of the third; `count` slots. 44 bytes a triangle, rounded up to whole units: 48, 96, 144,
/// 176, 224, 272, 320, 352. A kernel may read a full vector at a column's start, whatever its width up to 16 floats,
/// since kPadding units follow the last leaf.
struct TriangleLeaf {
  static constexpr uint32_t kMost = 8;
  static constexpr size_t kPadding = 4;
  static constexpr size_t kFloats = 11;  ///< of a triangle, its slot included

  const float* data;
  uint32_t count;

  static constexpr size_t units(size_t count) { return (kFloats * count + 3) / 4; }

  const float* column(uint32_t corner, uint32_t axis) const { return data + size_t{corner * 3 + axis} * count; }
  Triangle triangle(uint32_t i) const {
    const auto corner = [&](uint32_t c) { return Vec3f{column(c, 0)[i], column(c, 1)[i], column(c, 2)[i]}; };
    return {corner(0), corner(1), corner(2)};
  }
  LeafSlot slot(uint32_t i) const {
    uint32_t words[2];
    std::memcpy(words, data + size_t{9} * count + size_t{2} * i, sizeof words);
    return {words[0], words[1]};
  }
};

/// Units of a leaf of any primitives: one that begins with their number, then their slots.
constexpr size_t slots_units(size_t count) { return 1 + (count + 1) / 2; }
void write_slots(std::span<const LeafSlot> slots, LeafUnit* to);
void read_slots(const LeafUnit* from, std::vector<LeafSlot>& to);

/// Writes a TriangleLeaf of triangles that the slots name; `to` has room for units(count). A triangle without area is
/// written as a point, its first corner, which no ray hits.
void write_triangle_leaf(std::span<const LeafSlot> slots, std::span<const Geometry> geometries, LeafUnit* to);

}  // namespace kerf
