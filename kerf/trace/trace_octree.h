#pragma once

#include <span>

#include "kerf/trace/trace_table.h"
#include "kerf/tree/octree.h"

namespace kerf {

/// Traces rays through an Octree: children in the order that the ray's signs give, what waits behind the hit skipped.
/// A node's intervals come from the planes that cross it (Revelles, Urena, Lastra: An Efficient Parametric Algorithm
/// for Octree Traversal, 2000), each computed from its position, as BoxRay does it, for nothing must be missed. A child
/// whose interval is compared counts as a box test.
template <class Seen>
struct OctreeTracer {
  Octree tree;
  std::span<const Geometry> geometries;

  template <bool kAny, class Counts>
  Hit trace(const Ray& ray, Counts& counts) const;
};

/// Tests a primitive once for each ray if `mailbox`, as far as Mailbox remembers. The data must be an
/// OctreeTracer<Mailbox> then, else an OctreeTracer<NoMailbox>.
const TraceTable& octree_table(bool mailbox);

}  // namespace kerf
