#pragma once

#include "kerf/geometry/hit.h"

namespace kerf {

/// The nearest hit on the way through a tree whose leaves' kinds and places are words. Where a ray surely hits a
/// triangle, only between which t that is, is found out; the hit itself is worked out if it is still the nearest when
/// the way ends, or when another one is too near to tell which comes first.
struct NearestHit {
  Hit hit;              ///< hit.t: nothing farther matters; before any hit the ray's end
  float least;          ///< a hit before that t is nearer for certain
  uint32_t leaf = 0;    ///< word of the leaf of a triangle whose hit is to be worked out; 0: there is none
  uint32_t number = 0;  ///< of that triangle in its leaf

  explicit NearestHit(float t_max) : least(t_max) { hit.t = t_max; }
};

}  // namespace kerf
