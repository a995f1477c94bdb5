#pragma once

#include <cstdint>

#include "kerf/base/box3.h"
#include "kerf/base/parallel.h"

namespace kerf {

/// What came of a refit: the root, and what sah_cost() divides by its area.
struct RefitOutcome {
  Box3f bounds;     ///< of the root
  double area = 0;  ///< half the area of every inner node, and that of every leaf times its number of slots

  double sah_cost() const { return half_area(bounds) > 0 ? area / half_area(bounds) : 0; }
};

/// Makes the boxes of a subtree anew from the bottom up: a leaf's is leaf_bounds(first slot, count), an inner node's
/// the union of its children's. Returns RefitOutcome::area. `children(node)` gives the first and the second as
/// pointers. Both halves of upper levels run at once; boxes and sums do not depend on who came first.
template <class Node, class Children, class Leaf>
double refit_nodes(Node& node, const Children& children, const Leaf& leaf_bounds, uint32_t depth = 0) {
  constexpr uint32_t kTaskDepth = 10;
  Box3f box;
  double below = 0;
  if (node.is_leaf()) {
    box = leaf_bounds(node.first, node.count);
  } else {
    const auto [first, second] = children(node);
    double left = 0, right = 0;
    const auto refit_left = [&, child = first] { left = refit_nodes(*child, children, leaf_bounds, depth + 1); };
    const auto refit_right = [&, child = second] { right = refit_nodes(*child, children, leaf_bounds, depth + 1); };
    if (depth < kTaskDepth) {
      parallel_invoke(refit_left, refit_right);
    } else {
      refit_left();
      refit_right();
    }
    box = united(first->bounds(), second->bounds());
    below = left + right;
  }
  node.lower = box.lower;
  node.upper = box.upper;
  return below + half_area(box) * (node.is_leaf() ? node.count : 1);
}

}  // namespace kerf
