#pragma once

#include <algorithm>
#include <span>

#include "kerf/references/reference.h"

namespace kerf {

/// A box cut into slabs of equal width across one axis.
struct Slabs {
  uint32_t axis = 0, count = 1;
  float first = 0, extent = 0;  ///< where the box begins, and its length
  float scale = 0;              ///< slabs for each unit of length

  Slabs(const Box3f& box, uint32_t across, uint32_t slabs)
      : axis(across),
        count(slabs),
        first(box.lower[across]),
        extent(box.upper[across] - first),
        scale(static_cast<float>(slabs) / extent) {}

  /// False for a box that is flat here, or as good as.
  bool is_usable() const { return scale > 0 && scale < Box3f::kInfinity; }
  /// Where slab i begins.
  float plane(uint32_t i) const { return first + extent * (static_cast<float>(i) / static_cast<float>(count)); }
  uint32_t slab_of(float position) const {
    return static_cast<uint32_t>(std::clamp((position - first) * scale, 0.0F, static_cast<float>(count - 1)));
  }
};

inline constexpr uint32_t kMostSlabs = 16;

/// Extends bounds[i] by the box of what of a reference lies in slab i, for the slabs `begin` to `end`, which both hold
/// some of it. Good for judging planes, not for a tree: nothing is rounded outward, and a piece is cut from the whole
/// primitive's box there, which may be more than is left of it. bounds[0] is of slab 0.
void extend_by_parts(std::span<const Geometry> geometries, const Reference& reference, const Slabs& slabs,
                     uint32_t begin, uint32_t end, Box3f* bounds);

}  // namespace kerf
