#pragma once

#include "kerf/base/box3.h"

namespace kerf {

/// The boxes of what of something lies below and above a plane.
struct CutBoxes {
  Box3f below, above;
};

/// Both halves of a box. The plane must cross it.
constexpr CutBoxes halves(const Box3f& box, uint32_t axis, float position) {
  CutBoxes cut{box, box};
  cut.below.upper[axis] = position;
  cut.above.lower[axis] = position;
  return cut;
}

/// The rule of cells, which are closed, so that neighbours share the points of the plane between them: a part that
/// only touches the plane is left to the other side, and if rounding left nothing on either side both keep their half.
constexpr CutBoxes settled(CutBoxes cut, const Box3f& box, uint32_t axis, float position) {
  if (cut.below.is_empty() && cut.above.is_empty()) return halves(box, axis, position);
  if (!cut.above.is_empty() && cut.below.lower[axis] == position) {
    cut.below = {};
  } else if (!cut.below.is_empty() && cut.above.upper[axis] == position) {
    cut.above = {};
  }
  return cut;
}

}  // namespace kerf
