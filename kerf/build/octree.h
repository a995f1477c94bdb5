#pragma once

#include "kerf/base/work_limit.h"
#include "kerf/references/clipper.h"
#include "kerf/tree/octree.h"

namespace kerf {

/// How an octree or a quadtree is built.
struct OctreeOptions {
  uint32_t leaf_size = 8;   ///< a cell with more references than this is divided
  uint32_t max_depth = 16;  ///< at most kMaxDepth
  double cap = 16;          ///< slots for each reference, at most
  bool cube = false;        ///< the root is a cube at the lower corner of the box; else the box itself
  int undivided = -1;       ///< the axis that a quadtree does not divide; an octree: -1
};

/// The axis along which the references' box is shortest, the last of equal ones.
uint32_t shortest_axis(std::span<const Reference> references);

/// Divides cells at their middle (Glassner: Space Subdivision for Fast Ray Tracing, 1984), references clipped into
/// them, until a cell has `leaf_size` references, dividing costs more than it saves by the surface area heuristic, or
/// its share of the cap is used up: of the slots that the cap allows each child gets as many as it has references. The
/// same tree for any number of threads. LeafSlot::kRepeated is not set. Throws Error(stopped) at the limit.
Octree build_octree(std::span<const Reference> references, const Clipper& clipper, const OctreeOptions& options,
                    const WorkLimit& limit = {});

}  // namespace kerf
