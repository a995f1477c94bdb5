#pragma once

#include <span>

#include "kerf/layout/bvh2.h"
#include "kerf/trace/trace_table.h"

namespace kerf {

/// Traces rays through a Bvh2, one at a time, in scalar code: the nearer child first, a child behind the hit skipped.
struct Bvh2Tracer {
  Bvh2 layout;
  std::span<const Geometry> geometries;

  template <bool kAny, class Counts>
  Hit trace(const Ray& ray, Counts& counts) const;
};

const TraceTable& bvh2_table();

}  // namespace kerf
