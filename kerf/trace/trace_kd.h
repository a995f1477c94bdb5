#pragma once

#include <span>

#include "kerf/trace/trace_table.h"
#include "kerf/tree/kd_tree.h"

namespace kerf {

/// Traces rays through a kd-tree, one at a time, in scalar code: cells in the order of the ray, no further than the
/// first hit that surely lies before the next cell. With a mailbox a ray remembers the primitives that it tested last
/// and does not test them again.
template <bool kMailbox>
struct KdTracer {
  KdTree tree;
  std::span<const Geometry> geometries;

  template <bool kAny, class Counts>
  Hit trace(const Ray& ray, Counts& counts) const;
};

template <bool kMailbox>
const TraceTable& kd_table();

}  // namespace kerf
