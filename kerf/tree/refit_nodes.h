#pragma once

#include <cstdint>

#include "kerf/base/box3.h"
#include "kerf/base/parallel.h"

namespace kerf {

/// Sums over a subtree.
struct RefitSums {
  double nodes = 0;  ///< half the area of every inner node, and that of every leaf times its number of slots
  double parts = 0;  ///< the area of what is in the leaves, see Fragments::Part
};

/// What came of a refit.
struct RefitOutcome {
  Box3f bounds;  ///< of the root
  RefitSums sums;

  double sah_cost() const { return half_area(bounds) > 0 ? sums.nodes / half_area(bounds) : 0; }
};

/// Makes the boxes of a subtree anew from the bottom up: a leaf's is that of leaf_parts(first slot, count), an inner
/// node's the union of its children's. `children(node)` gives the first and the second as pointers. Both halves of
/// upper levels run at once; boxes and sums do not depend on who came first.
template <class Node, class Children, class LeafParts>
RefitSums refit_nodes(Node& node, const Children& children, const LeafParts& leaf_parts, uint32_t depth = 0) {
  constexpr uint32_t kTaskDepth = 10;
  Box3f box;
  RefitSums sums;
  if (node.is_leaf()) {
    const auto [bounds, area] = leaf_parts(node.first, node.count);
    box = bounds;
    sums.parts = area;
  } else {
    const auto [first, second] = children(node);
    RefitSums left, right;
    const auto refit_left = [&, child = first] { left = refit_nodes(*child, children, leaf_parts, depth + 1); };
    const auto refit_right = [&, child = second] { right = refit_nodes(*child, children, leaf_parts, depth + 1); };
    if (depth < kTaskDepth) {
      parallel_invoke(refit_left, refit_right);
    } else {
      refit_left();
      refit_right();
    }
    box = united(first->bounds(), second->bounds());
    sums = {left.nodes + right.nodes, left.parts + right.parts};
  }
  node.lower = box.lower;
  node.upper = box.upper;
  sums.nodes += half_area(box) * (node.is_leaf() ? node.count : 1);
  return sums;
}

}  // namespace kerf
