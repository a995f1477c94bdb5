#include "kerf/layout/quantised_leaf.h"

#include <algorithm>
#include <array>
#include <bit>
#include <variant>

#include "kerf/geometry/ray_triangle.h"

namespace kerf {
namespace {

/// The different corners of a leaf's triangles, and which each triangle has.
class Corners {
 public:
  Corners(std::span<const LeafSlot> slots, std::span<const Geometry> geometries, CornerKind kind) {
    for (const LeafSlot& slot : slots) {
      const auto& mesh = std::get<TriangleMesh>(geometries[slot.geometry()].shapes);
      const Triangle t = mesh.triangle(slot.primitive);
      const TriangleCorners vertices = mesh.triangles[slot.primitive];
      const Vec3f places[3] = {t.a, t.b, t.c};
      const bool is_point = is_degenerate(t);
      uint32_t word = 0;
      for (uint32_t c = 0; c < 3; ++c) {
        // Of a point the others count where they may come to be some: after a refit.
        const Vec3f place = is_point && kind == CornerKind::places ? places[0] : places[c];
        const uint32_t number = kind == CornerKind::vertices
                                    ? add(place, {slot.geometry(), vertices[c], 0})
                                    : add(place, {std::bit_cast<uint32_t>(place.x), std::bit_cast<uint32_t>(place.y),
                                                  std::bit_cast<uint32_t>(place.z)});
        const uint32_t written = is_point && c > 0 ? QuantisedLeaf::corner_number(word, 0) : number;
        word |= written << (QuantisedLeaf::kCornerBits * c);
      }
      words_[triangles_++] = static_cast<uint16_t>(word | (slot.geometry_bits >> 16 & kRepeatedBit));
    }
  }

  uint32_t count() const { return count_; }
  Vec3f place(uint32_t i) const { return places_[i]; }
  const uint16_t* words() const { return words_.data(); }

 private:
  using Key = std::array<uint32_t, 3>;
  static constexpr uint32_t kRepeatedBit = LeafSlot::kRepeated >> 16;

  uint32_t add(Vec3f place, const Key& key) {
    const auto end = keys_.begin() + count_;
    const auto found = std::find(keys_.begin(), end, key);
    if (found != end) return static_cast<uint32_t>(found - keys_.begin());
    keys_[count_] = key;
    places_[count_] = place;
    return count_++;
  }

  std::array<Key, QuantisedLeaf::kMostCorners> keys_;
  std::array<Vec3f, QuantisedLeaf::kMostCorners> places_;
  std::array<uint16_t, QuantisedLeaf::kMost> words_;
  uint32_t count_ = 0, triangles_ = 0;
};

bool is_mixed(std::span<const LeafSlot> slots) {
  const uint32_t first = slots[0].geometry();
  return first >= QuantisedLeaf::kMostShared ||
         !std::all_of(slots.begin(), slots.end(), [&](const LeafSlot& slot) { return slot.geometry() == first; });
}

}  // namespace

QuantisedLeafSize quantised_leaf_size(std::span<const LeafSlot> slots, std::span<const Geometry> geometries,
                                      CornerKind kind) {
  const uint32_t corners = Corners(slots, geometries, kind).count();
  return {corners, QuantisedLeaf::units(slots.size(), corners, is_mixed(slots))};
}

uint32_t write_quantised_leaf(std::span<const LeafSlot> slots, std::span<const Geometry> geometries, CornerKind kind,
                              LeafUnit* to) {
  const Corners corners(slots, geometries, kind);
  const auto count = static_cast<uint32_t>(slots.size());
  const bool mixed = is_mixed(slots);
  float* const data = to->values;
  const uint32_t head = (count - 1) | (mixed ? QuantisedLeaf::kIsMixed : slots[0].geometry() << 4);
  std::memcpy(data, &head, sizeof head);
  float* const columns = data + 1;
  for (uint32_t i = 0; i < corners.count(); ++i) {
    for (uint32_t axis = 0; axis < 3; ++axis) columns[axis * corners.count() + i] = corners.place(i)[axis];
  }
  float* const words = columns + size_t{3} * corners.count();
  std::memcpy(words, corners.words(), count * sizeof(uint16_t));
  float* const primitives = words + (count + 1) / 2;
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t geometry = slots[i].geometry();
    std::memcpy(primitives + i, &slots[i].primitive, sizeof(uint32_t));
    if (mixed) std::memcpy(primitives + count + i, &geometry, sizeof geometry);
  }
  return corners.count();
}

}  // namespace kerf
