#pragma once

#include <cstdint>
#include <cstring>

#include "kerf/geometry/geometry.h"
#include "kerf/layout/triangle_leaf.h"
#include "kerf/tree/bvh.h"

namespace kerf {

/// Up to eight triangles that share their corners, as kernels read them: 4 bytes about all of them; columns of x, y and
/// z of the different corners; a word of two bytes for each triangle, with the numbers of its corners; then the numbers
/// of the primitives and, where they are not of one geometry, of the geometries. 20 to 30 bytes a triangle of a mesh.
/// A kernel may read a full vector at a column's or the words' start, whatever its width up to 16 floats, since
/// TriangleLeaf::kPadding units follow the last leaf.
struct QuantisedLeaf {
  static constexpr uint32_t kMost = TriangleLeaf::kMost, kMostCorners = 3 * kMost;
  static constexpr uint32_t kCornerBits = 5;  ///< of a number in a word; the first corner's are the lowest

  const float* data;
  uint32_t corners;  ///< how many are different

  /// Which geometry all triangles are of, if that is so and it fits.
  static constexpr uint32_t kMostShared = 1U << 28, kIsMixed = 8;

  uint32_t count() const { return (head() & 7) + 1; }
  bool is_mixed() const { return (head() & kIsMixed) != 0; }
  size_t units() const { return units(count(), corners, is_mixed()); }
  static constexpr size_t units(size_t count, size_t corners, bool is_mixed) {
    return (1 + 3 * corners + (count + 1) / 2 + (is_mixed ? 2 : 1) * count + 3) / 4;
  }
  const float* column(uint32_t axis) const { return data + 1 + size_t{axis} * corners; }
  const float* words() const { return column(3); }  ///< of two bytes

  uint32_t word(uint32_t i) const {
    uint16_t word = 0;
    std::memcpy(&word, reinterpret_cast<const char*>(words()) + sizeof word * i, sizeof word);
    return word;
  }
  static uint32_t corner_number(uint32_t word, uint32_t corner) {
    return word >> (kCornerBits * corner) & ((1U << kCornerBits) - 1);
  }
  Vec3f corner(uint32_t number) const { return {column(0)[number], column(1)[number], column(2)[number]}; }
  Triangle triangle(uint32_t i) const {
    const uint32_t w = word(i);
    return {corner(corner_number(w, 0)), corner(corner_number(w, 1)), corner(corner_number(w, 2))};
  }
  LeafSlot slot(uint32_t i) const {
    const float* const primitives = words() + (count() + 1) / 2;
    const uint32_t geometry = is_mixed() ? value(primitives + count() + i) : head() >> 4;
    return {geometry | (word(i) & kRepeatedWord) << 16, value(primitives + i)};
  }

 private:
  static constexpr uint32_t kRepeatedWord = 0x8000;
  static_assert(LeafSlot::kRepeated == kRepeatedWord << 16 && 3 * kCornerBits == 15);

  static uint32_t value(const float* at) {
    uint32_t value = 0;
    std::memcpy(&value, at, sizeof value);
    return value;
  }
  uint32_t head() const { return value(data); }
};

/// What tells corners apart that a leaf holds once each.
enum class CornerKind : uint8_t {
  places,    ///< their coordinates, to the bit
  vertices,  ///< the caller's number of the vertex: the same when vertices have moved
};

struct QuantisedLeafSize {
  uint32_t corners = 0;
  size_t units = 0;
};
/// Of the leaf of triangles that the slots name; of at most kMost.
QuantisedLeafSize quantised_leaf_size(std::span<const LeafSlot> slots, std::span<const Geometry> geometries,
                                      CornerKind kind);

/// Writes it and returns its number of corners; `to` has room for its units, all zero or what was written there for
/// the same slots. A triangle without area is written as a point, its first corner, which no ray hits.
uint32_t write_quantised_leaf(std::span<const LeafSlot> slots, std::span<const Geometry> geometries, CornerKind kind,
                              LeafUnit* to);

}  // namespace kerf
