#include "kerf/build/movable_tree.h"

#include <algorithm>

namespace kerf {

/// A node and all above it, the root last.
struct MovableTree::Path {
  uint32_t node[kMaxDepth + 1];
  uint32_t count = 0;

  Path(const MovableTree& tree, uint32_t n) {
    for (; n != 0; n = tree[n].parent) node[count++] = n;
  }
};

MovableTree::MovableTree(const Bvh& bvh)
    : pairs_(bvh.nodes.size() / 2 + 1), heights_(bvh.nodes.size() + 1), slot_counts_(bvh.slots.size()) {
  for (uint32_t n = end() - 1; n >= kRoot; --n) {  // children come after their parents
    const BvhNode& from = bvh.nodes[n - 1];
    Node& node = at(n);
    node.lower = from.lower;
    node.upper = from.upper;
    if (from.is_leaf()) {
      node.below = 2 * from.first + 1;
      slot_counts_[from.first] = from.count;
    } else {
      node.below = from.first + 1;
      at(node.below).parent = at(node.below + 1).parent = n;
      heights_[n] = static_cast<uint8_t>(std::max(heights_[node.below], heights_[node.below + 1]) + 1);
    }
  }
}

double MovableTree::saving(uint32_t n, uint32_t x) const {
  const MovableTree& tree = *this;
  if (n == kRoot || x == n || x == (n ^ 1) || x == tree[n].parent) return 0;
  const Path from(tree, tree[n].parent), to(tree, x);
  uint32_t left = from.count, right = to.count;  // nodes below the last that both have in common
  while (left > 0 && right > 0 && from.node[left - 1] == to.node[right - 1]) --left, --right;
  if (left == 0 && to.node[right - 1] == n) return 0;

  // n's parent goes, so n's side of the tree comes up by one where x is on it.
  const uint32_t depth = to.count - (left == 0 ? 1 : 0);
  if (depth + std::max(heights_[n], heights_[x]) > kMaxDepth) return 0;

  double saved = half_area(tree[from.node[0]].bounds());
  Box3f rest = tree[n ^ 1].bounds();
  for (uint32_t i = 1; i < left; ++i) {
    rest.extend(tree[from.node[i - 1] ^ 1].bounds());
    saved += half_area(tree[from.node[i]].bounds()) - half_area(rest);
  }
  if (right == 0) return saved - half_area(united(rest, tree[from.node[left - 1] ^ 1].bounds()));  // x shrinks, too
  const Box3f box = tree[n].bounds();
  for (uint32_t i = 1; i < right; ++i) {
    const Box3f old = tree[to.node[i]].bounds();
    saved -= half_area(united(old, box)) - half_area(old);
  }
  return saved - half_area(united(tree[x].bounds(), box));
}

void MovableTree::move(uint32_t n, uint32_t x) {
  const uint32_t parent = at(n).parent, sibling = n ^ 1;
  put(parent, at(sibling), heights_[sibling]);
  put(sibling, at(x), heights_[x]);
  at(n).parent = at(sibling).parent = x;
  at(x).below = std::min(n, sibling);
  refit_upward(at(parent).parent);
  refit_upward(x);
}

/// Makes n what another node was, but for its place.
void MovableTree::put(uint32_t n, const Node& content, uint8_t height) {
  Node& node = at(n);
  const uint32_t parent = node.parent;
  node = content;
  node.parent = parent;
  heights_[n] = height;
  if (!node.is_leaf()) at(node.below).parent = at(node.below + 1).parent = n;
}

void MovableTree::refit_upward(uint32_t n) {
  for (; n != 0; n = at(n).parent) {
    Node& node = at(n);
    const Box3f box = united(at(node.below).bounds(), at(node.below + 1).bounds());
    const auto height = static_cast<uint8_t>(std::max(heights_[node.below], heights_[node.below + 1]) + 1);
    if (box == node.bounds() && height == heights_[n]) return;
    node.lower = box.lower;
    node.upper = box.upper;
    heights_[n] = height;
  }
}

}  // namespace kerf
