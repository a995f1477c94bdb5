#pragma once

#include <span>
#include <vector>

#include "kerf/tree/bvh.h"

namespace kerf {

/// A Bvh in which subtrees can be moved. Its leaves stay whole, each box is at all times the union of the children's,
/// and no path becomes longer than kMaxDepth.
class MovableTree {
 public:
  static constexpr uint32_t kRoot = 1;

  /// The sibling of node n is n ^ 1: the two children of a node share a cache line. 32 bytes.
  struct alignas(16) Node {
    Vec3f lower;
    uint32_t below = 0;  ///< inner node: the lower number of its children, an even one; leaf: 2 x its first slot + 1
    Vec3f upper;
    uint32_t parent = 0;

    bool is_leaf() const { return below % 2 != 0; }
    uint32_t first_slot() const { return below / 2; }
    Box3f bounds() const { return {lower, upper}; }
  };

  /// What one takes.
  static size_t bytes_for(const Bvh& bvh) {
    return bvh.nodes.size() * (sizeof(Node) + sizeof(uint8_t)) + bvh.slots.size() * sizeof(uint32_t);
  }
  /// Of a tree with nodes, none of them deeper than kMaxDepth.
  explicit MovableTree(const Bvh& bvh);

  const Node& operator[](uint32_t n) const { return pairs_[n / 2].node[n % 2]; }
  /// Numbers are kRoot to end() - 1.
  uint32_t end() const { return static_cast<uint32_t>(heights_.size()); }
  /// Of a leaf.
  uint32_t slot_count(const Node& leaf) const { return slot_counts_[leaf.first_slot()]; }

  /// What the sum of the inner nodes' half areas falls by if n, with all below, becomes the sibling of x; nothing if
  /// that is no move, or one that would make a path too long.
  double saving(uint32_t n, uint32_t x) const;
  /// Makes a move for which saving() is not 0. What n's sibling, n's parent and x stand for changes.
  void move(uint32_t n, uint32_t x);

 private:
  struct alignas(64) Pair {
    Node node[2];
  };
  struct Path;

  Node& at(uint32_t n) { return pairs_[n / 2].node[n % 2]; }
  void put(uint32_t n, const Node& content, uint8_t height);
  void refit_upward(uint32_t n);

  std::vector<Pair> pairs_;            ///< of the first only the second is used: the root
  std::vector<uint8_t> heights_;       ///< edges to the deepest leaf below, by node
  std::vector<uint32_t> slot_counts_;  ///< by a leaf's first slot
};

}  // namespace kerf
