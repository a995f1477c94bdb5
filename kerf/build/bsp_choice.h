#pragma once

#include <optional>

#include "kerf/build/bsp_pieces.h"
#include "kerf/build/bsp_sah.h"
#include "kerf/build/convex_cell.h"

namespace kerf {

/// The plane that makes a cell cheapest for a ray that meets it, of those that leave at most `most_references` in both
/// parts together; nothing where a leaf is cheaper.
std::optional<BspPlane> cheapest_plane(const ConvexCell& cell, const Box3f& cell_bounds, const BspPieces& pieces,
                                       uint64_t most_references, const BspOptions& options);

}  // namespace kerf
