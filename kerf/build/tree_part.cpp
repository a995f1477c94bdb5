#include "kerf/build/tree_part.h"

#include <utility>

#include "kerf/base/parallel.h"

namespace kerf {
namespace {

constexpr size_t kParallelCount = 16384;  // fewer nodes are not worth a task

/// Puts the nodes below a part from `place` on; the part's root as it is in the tree.
BvhNode put(TreePart& part, std::vector<BvhNode>& nodes, size_t place) {
  BvhNode root = part.root;
  if (root.is_leaf()) return root;
  if (!part.child) {
    const auto moved = [place](BvhNode node) {
      if (!node.is_leaf()) node.first += static_cast<uint32_t>(place);
      return node;
    };
    for (size_t i = 0; i < part.below.size(); ++i) nodes[place + i] = moved(part.below[i]);
    std::vector<BvhNode>().swap(part.below);
    part.held.release();
    return moved(root);
  }
  const size_t first_count = part.child[0].count_below(), second_count = part.child[1].count_below();
  const auto put_first = [&] { nodes[place] = put(part.child[0], nodes, place + 2); };
  const auto put_second = [&] { nodes[place + 1] = put(part.child[1], nodes, place + 2 + first_count); };
  if (first_count + second_count >= kParallelCount) {
    parallel_invoke(put_first, put_second);
  } else {
    put_first();
    put_second();
  }
  root.first = static_cast<uint32_t>(place);
  return root;
}

}  // namespace

std::vector<BvhNode> joined(TreePart tree) {
  std::vector<BvhNode> nodes(1 + tree.count_below());
  const HeldBytes held(nodes.size() * sizeof(BvhNode));
  nodes[0] = put(tree, nodes, 1);
  return nodes;
}

}  // namespace kerf
