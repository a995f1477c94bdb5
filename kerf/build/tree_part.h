#pragma once

#include <memory>
#include <vector>

#include "kerf/base/work_limit.h"
#include "kerf/tree/bvh.h"

namespace kerf {

/// A tree, or a part of one, as the threads that made it left it.
struct TreePart {
  BvhNode root;                       ///< of an inner one `first` has no meaning yet where there are children
  std::vector<BvhNode> below;         ///< pairs in depth-first order, numbered from 0; without children
  std::unique_ptr<TreePart[]> child;  ///< two, of a part that was divided among threads
  HeldBytes held;

  size_t count_below() const { return child ? 2 + child[0].count_below() + child[1].count_below() : below.size(); }
};

/// All nodes of a tree: the root, then pairs in depth-first order. Each part is freed when it is done.
std::vector<BvhNode> joined(TreePart tree);

}  // namespace kerf
