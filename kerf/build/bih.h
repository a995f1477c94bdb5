#pragma once

#include "kerf/build/top_down.h"
#include "kerf/tree/bih.h"

namespace kerf {

/// Partitions at the planes of a grid that is given by the scene's box alone (Waechter, Keller: Instant Ray Tracing:
/// The Bounding Interval Hierarchy, 2006, their global heuristic): the box is halved across its longest side, again and
/// again, halves without references are passed over, and each reference goes to the side where its centre lies. In
/// place; the depth bound and the leaf decision are those of build_top_down(). Where a pair of children takes up at
/// most `cut_off` of the area of what the planes above leave them, a single-child node cuts that down along one axis,
/// as long as the depth allows; 0: never. LeafSlot::kRepeated is not set. Throws as build_top_down() does, and
/// Error(too_large) above BihNode::kMostNodes.
Bih build_bih(std::vector<Reference> references, const TopDownOptions& options, double cut_off,
              const WorkLimit& limit = {});

}  // namespace kerf
