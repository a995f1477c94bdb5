#pragma once

#include <span>

#include "kerf/trace/trace_table.h"
#include "kerf/tree/bih.h"

namespace kerf {

/// Traces rays through a Bih: an interval of the ray, shortened by one plane for each child, the nearer child first,
/// what waits behind the hit skipped. No early exit, because children may overlap. A child whose interval is compared
/// counts as a box test.
struct BihTracer {
  Bih bih;
  std::span<const Geometry> geometries;

  template <bool kAny, class Counts>
  Hit trace(const Ray& ray, Counts& counts) const;
};

const TraceTable& bih_table();

}  // namespace kerf
