#pragma once

#include "kerf/build/top_down.h"
#include "kerf/tree/bih.h"

namespace kerf {

/// Partitions at the planes of a grid that is given by the scene's box alone (Waechter, Keller: Instant Ray Tracing:
/// The Bounding Interval Hierarchy, 2006, their global heuristic): the box is halved across its longest side, again and
/// again, halves without references are passed over, and each reference goes to the side where its centre lies. In
/// place; the depth bound and the leaf decision are those of build_top_down(). LeafSlot::kRepeated is not set.
Bih build_bih(std::vector<Reference> references, const TopDownOptions& options, const WorkLimit& limit = {});

}  // namespace kerf
