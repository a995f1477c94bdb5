#pragma once

#include <span>

#include "kerf/geometry/geometry.h"
#include "kerf/geometry/hit.h"
#include "kerf/tree/bvh.h"

namespace kerf {

/// Tests one primitive and keeps its hit in `best` if that is closer. best.t is the limit: the ray's end at first.
inline bool test_primitive(std::span<const Geometry> geometries, const LeafSlot& slot, const PreparedRay& ray,
                           Hit& best) {
  const Geometry& geometry = geometries[slot.geometry()];
  Crossing crossing;
  if ((geometry.mask & ray.mask) == 0 || !intersect(geometry, slot.primitive, ray, best.t, crossing)) return false;
  const Hit hit{crossing.t, crossing.u, crossing.v, slot.primitive, slot.geometry(), kNone};
  if (best && !closer(hit, best)) return false;
  best = hit;
  return true;
}

/// The same, and counts the test. A template over Counts costs nothing where counts are not wanted.
template <class Counts>
bool test_primitive(std::span<const Geometry> geometries, const LeafSlot& slot, const PreparedRay& ray, Hit& best,
                    Counts& counts) {
  counts.count_primitives(std::span(&slot, 1));
  return test_primitive(geometries, slot, ray, best);
}

/// What trace() returns: the hit found, or a miss with infinite t.
inline Hit finished(const Hit& best) { return best ? best : Hit{}; }

}  // namespace kerf
