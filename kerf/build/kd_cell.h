#pragma once

#include <vector>

#include "kerf/base/work_limit.h"
#include "kerf/build/kd_events.h"
#include "kerf/references/clipper.h"

namespace kerf {

/// A cell that is still to be divided, and what reaches into it.
struct KdCell {
  Box3f bounds;
  std::vector<Reference> references;  ///< their boxes cut to the cell; by geometry, then primitive
  KdEvents events;                    ///< of the references; not used before `has_events`
  bool has_events = false;
  uint64_t allowed = 0;  ///< references that the leaves below may have, all together
  uint32_t depth = 0;
  bool is_of_trial = false;  ///< made by a division that does not pay by itself
  HeldBytes held;            ///< of a large cell

  size_t bytes() const {
    size_t bytes = references.capacity() * sizeof(Reference);
    for (const std::vector<KdEvent>& line : events) bytes += line.capacity() * sizeof(KdEvent);
    return bytes;
  }
};

struct KdHalves {
  KdCell below, above;
  size_t cuts = 0;
};

/// Divides a cell at a plane: references on one side go there, flat ones in the plane where it says, and those across
/// it are cut (without a clipper: their boxes are) and go where a part of them lies. What is left of `allowed` is
/// shared in proportion to the counts. Neither half may have events yet where the cell has none.
KdHalves divide(const KdCell& cell, const KdPlane& plane, const Clipper* clipper);

}  // namespace kerf
