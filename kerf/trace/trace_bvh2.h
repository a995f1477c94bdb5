#pragma once

#include <span>

#include "kerf/layout/bvh2.h"
#include "kerf/trace/ray_box.h"
#include "kerf/trace/slab_tests.h"
#include "kerf/trace/trace_table.h"

namespace kerf {

/// Which of two children that the ray enters is visited first.
enum class ChildOrder : uint8_t {
  entry,  ///< the one that it enters first; the other waits on a stack
  fixed,  ///< the first
  axis,   ///< by the sign of its direction along the axis that mark_axes() chose (Mahovsky 2005)
  heap,   ///< of all nodes that wait, the one that it enters first (Kay and Kajiya 1986)
};

/// Traces rays through a Bvh2, one at a time, in scalar code; a child behind the hit is skipped.
template <ChildOrder kOrder, class BoxTest>
struct Bvh2TracerOf {
  Bvh2 layout;  ///< for ChildOrder::axis after mark_axes()
  std::span<const Geometry> geometries;

  template <bool kAny, class Counts>
  Hit trace(const Ray& ray, Counts& counts) const;

  /// There is one for each order with BoxRay, and for each box test with ChildOrder::entry.
  static const TraceTable& table();
};

using Bvh2Tracer = Bvh2TracerOf<ChildOrder::entry, BoxRay>;
inline const TraceTable& bvh2_table() { return Bvh2Tracer::table(); }

}  // namespace kerf
