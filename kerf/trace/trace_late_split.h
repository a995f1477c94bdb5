#pragma once

#include <span>

#include "kerf/trace/trace_table.h"
#include "kerf/tree/late_split_bvh.h"

namespace kerf {

/// Traces rays through a LateSplitBvh as through a Bvh2: the nearer child first, a child behind the hit skipped.
///
/// With `restores`, no primitive is tested twice for its pieces (Ernst and Greiner 2007, section 5.1): when the ray
/// enters a cut leaf, the height of the stack is kept, and after the first piece whose box it enters, it is restored.
/// That is right because a piece stands for its whole primitive: one test finds what all of them could.
struct LateSplitTracer {
  LateSplitBvh tree;
  std::span<const Geometry> geometries;
  bool restores = true;

  template <bool kAny, class Counts>
  Hit trace(const Ray& ray, Counts& counts) const;
};

const TraceTable& late_split_table();

}  // namespace kerf
