#pragma once

#include <span>

#include "kerf/trace/trace_table.h"
#include "kerf/tree/bsp_tree.h"

namespace kerf {

/// Traces rays through a BspTree, one at a time: the cell on the ray's side of each plane first, until a hit lies
/// before the next cell. The one box that is tested is that of everything.
struct BspTracer {
  BspTree tree;
  std::span<const Geometry> geometries;

  template <bool kAny, class Counts>
  Hit trace(const Ray& ray, Counts& counts) const;
};

const TraceTable& bsp_table();

}  // namespace kerf
