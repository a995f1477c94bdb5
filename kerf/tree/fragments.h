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
  /// Of a finished tree of so many primitives, repeats marked, over the geometries at rest. Parallel; the outcome does
  /// not depend on the number of threads.
  Fragments(const Bvh& bvh, std::span<const Geometry> geometries, size_t primitives);

  /// What slot number `number` stands for, as the primitives are now.
  struct Part {
    Box3f bounds;
    /// What a tree built anew has to hold of it: half the area of its box, but where primitives are cut, as they could
    /// be again, that of its surface.
    double area = 0;
  };
  Part part(size_t number, const LeafSlot& slot, std::span<const Geometry> geometries) const {
    const Geometry& geometry = geometries[slot.geometry()];
    const std::span<const FragmentCorner> corners =
        slot.is_repeated() ? corners_of(number) : std::span<const FragmentCorner>{};
    const Box3f bounds = fragment_bounds(geometry, slot.primitive, corners);
    return {bounds, is_split_ ? fragment_area(geometry, slot.primitive, corners) : half_area(bounds)};
  }

  size_t bytes() const { return places_.size() * sizeof(uint64_t) + corners_.size() * sizeof(FragmentCorner); }

 private:
  std::span<const FragmentCorner> corners_of(size_t number) const {
    const uint64_t place = places_[number];
    return std::span(corners_).subspan(place / kPerCount, place % kPerCount);
  }

  static constexpr double kSplit = 1.1;  // references for each primitive from which a tree counts as split
  static constexpr uint64_t kPerCount = kMaxFragmentCorners + 1;

  std::vector<uint64_t> places_;  ///< of each slot: its first corner times kPerCount, plus their number; or none at all
  std::vector<FragmentCorner> corners_;
  bool is_split_ = false;
};

/// What leaves hold by now, for refit_nodes().
struct LeafParts {
  const Fragments& fragments;
  std::span<const LeafSlot> slots;
  std::span<const Geometry> geometries;

  Fragments::Part operator()(size_t first, size_t count) const {
    Fragments::Part all;
    for (size_t i = first; i < first + count; ++i) {
      const Fragments::Part part = fragments.part(i, slots[i], geometries);
      all.bounds.extend(part.bounds);
      all.area += part.area;
    }
    return all;
  }
};

/// The sum of the areas of all parts of a tree.
double parts_area(const Bvh& bvh, const LeafParts& parts);

}  // namespace kerf
