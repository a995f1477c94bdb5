#pragma once

#include <span>

#include "kerf/trace/trace_table.h"
#include "kerf/tree/uniform_grid.h"

namespace kerf {

/// Traces rays through a UniformGrid: its bounds, then cell by cell until the next one lies behind the hit. Bounds and
/// cells count as nodes, only the bounds as a box test.
template <class Seen>
struct UniformGridTracer {
  UniformGrid grid;
  std::span<const Geometry> geometries;

  template <bool kAny, class Counts>
  Hit trace(const Ray& ray, Counts& counts) const;
};

/// Tests a primitive once for each ray if `mailbox`, as far as Mailbox remembers. The data must be a
/// UniformGridTracer<Mailbox> then, else a UniformGridTracer<NoMailbox>.
const TraceTable& uniform_grid_table(bool mailbox);

}  // namespace kerf
