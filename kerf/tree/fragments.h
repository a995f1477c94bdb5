#pragma once

#include <cstdint>
#include <vector>

#include "kerf/geometry/fragment.h"
#include "kerf/tree/bvh.h"

namespace kerf {

/// Which part of its primitive each slot of a tree stands for, so that the tree can be refitted to moved vertices.
///
/// A primitive with one reference is whole wherever it goes, and nothing is kept of it. Of one with several, a slot
/// stands for what lay in its leaf's box at rest. Those boxes held every point of the primitive, so the parts cover it
/// at rest, and being fixed in its own coordinates they cover it wherever its vertices go. The leaf's box may be larger
/// than the reference's was, which is gone; but all of a leaf is tested together, so nothing would be gained by it.
class Fragments {
 public:
  Fragments() = default;
  /// Of a finished tree, repeats marked, over the geometries at rest. Parallel; the outcome does not depend on it.
  Fragments(const Bvh& bvh, std::span<const Geometry> geometries);

  /// A box around the part that slot number `number` stands for, of the primitives as they are now.
  Box3f bounds(size_t number, const LeafSlot& slot, std::span<const Geometry> geometries) const {
    if (!slot.is_repeated()) return primitive_bounds(geometries[slot.geometry()], slot.primitive);
    return fragment_bounds(geometries[slot.geometry()], slot.primitive, corners_of(number));
  }

  size_t bytes() const { return places_.size() * sizeof(uint64_t) + corners_.size() * sizeof(FragmentCorner); }

 private:
  std::span<const FragmentCorner> corners_of(size_t number) const {
    const uint64_t place = places_[number];
    return std::span(corners_).subspan(place / kPerCount, place % kPerCount);
  }

  static constexpr uint64_t kPerCount = kMaxFragmentCorners + 1;

  std::vector<uint64_t> places_;  ///< of each slot: its first corner times kPerCount, plus their number; or none at all
  std::vector<FragmentCorner> corners_;
};

/// What a leaf holds by now, for refit_nodes().
struct LeafBounds {
  const Fragments& fragments;
  std::span<const LeafSlot> slots;
  std::span<const Geometry> geometries;

  Box3f operator()(size_t first, size_t count) const {
    Box3f box;
    for (size_t i = first; i < first + count; ++i) box.extend(fragments.bounds(i, slots[i], geometries));
    return box;
  }
};

}  // namespace kerf
