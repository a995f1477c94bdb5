#pragma once

#include <vector>

#include "kerf/base/work_limit.h"
#include "kerf/build/movable_tree.h"

namespace kerf {

/// When a subtree becomes a leaf.
struct LeafRule {
  uint32_t leaf_size = 4;  ///< slots in a leaf that is made, at most
  double inner_cost = 1, primitive_cost = 1;
  double leaf_cost = 0;  ///< besides its primitives

  double as_leaf(uint32_t slots) const { return leaf_cost + primitive_cost * slots; }
};

/// The cheapest tree by the surface area heuristic that comes from making some of a tree's subtrees leaves; leaves that
/// are there stay whole. The tree must not change meanwhile.
class Collapse {
 public:
  Collapse(const MovableTree& tree, const LeafRule& rule);

  /// The tree with its leaves' slots, which were `slots` in the tree at first. Of two children the first has more of
  /// them.
  Bvh bvh(const std::vector<LeafSlot>& slots) const;

 private:
  struct Summary {
    uint32_t slots = 0;
    uint32_t nodes = 0;  ///< below, of those that stay; 0: a leaf
  };

  /// Where a node of the tree goes: to which number, from which on its descendants' and its slots'.
  struct Place {
    uint32_t from = 0, to = 0, below = 0, slot = 0, depth = 0;
  };

  double choose(uint32_t n, uint32_t depth);
  void write(Bvh& bvh, const std::vector<LeafSlot>& slots, const Place& place) const;
  void copy_slots(Bvh& bvh, const std::vector<LeafSlot>& slots, uint32_t n, uint32_t& to) const;

  const MovableTree& tree_;
  LeafRule rule_;
  HeldBytes held_;
  std::vector<Summary> summaries_;
};

}  // namespace kerf
