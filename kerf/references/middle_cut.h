#pragma once

#include <optional>

#include "kerf/references/clipper.h"

namespace kerf {

/// The reference with another box.
inline Reference with_box(Reference reference, const Box3f& box) {
  reference.lower = box.lower;
  reference.upper = box.upper;
  return reference;
}

/// The spatial median cut of split clipping: the boxes of the two parts on either side of the middle of the longest
/// side, at most one of them empty. Nothing if there is no float between the sides.
inline std::optional<ClippedBoxes> cut_in_the_middle(const Reference& reference, const Clipper& clipper) {
  const Box3f box = reference.bounds();
  const uint32_t axis = largest_axis(box.extent());
  const float middle = center(box, axis);
  if (!(box.lower[axis] < middle && middle < box.upper[axis])) return std::nullopt;
  const ClippedBoxes parts = clipper(reference, axis, middle);
  // Only rounding can leave nothing on either side: keep what we had.
  if (parts.below.is_empty() && parts.above.is_empty()) return std::nullopt;
  return parts;
}

}  // namespace kerf
