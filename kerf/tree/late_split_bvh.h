#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kerf/base/box3.h"
#include "kerf/geometry/geometry.h"
#include "kerf/tree/bvh.h"

namespace kerf {

/// A box of a LateSplitBvh and what is in it. 32 bytes.
struct LateSplitNode {
  enum Kind : uint32_t {
    kInner,       ///< of the standard tree: children in pair `first`
    kWholeLeaf,   ///< a leaf of the standard tree that was not cut: slot `first`
    kCutLeaf,     ///< a leaf of the standard tree that was cut: pieces in pair `first`
    kInnerPiece,  ///< below a cut leaf: smaller pieces in pair `first`
    kPiece,       ///< below a cut leaf, not cut further: slot `first`, that of all of the cut leaf's pieces
  };

  Vec3f lower;
  uint32_t first = 0;
  Vec3f upper;
  Kind kind = kWholeLeaf;

  bool is_leaf() const { return kind == kWholeLeaf || kind == kPiece; }
  Box3f bounds() const { return {lower, upper}; }
  /// The lower sides as floats 0 to 2, the upper ones as 4 to 6.
  const float* sides() const { return &lower.x; }
  friend bool operator==(const LateSplitNode&, const LateSplitNode&) = default;
};
static_assert(sizeof(LateSplitNode) == 32 && offsetof(LateSplitNode, upper) == 16);

/// Two nodes side by side: one cache line of 64 bytes decides about both.
struct alignas(64) LateSplitPair {
  LateSplitNode child[2];
};

/// A binary tree over single primitives whose large leaves were cut into trees of pieces: plain data. A pair comes
/// after that of its parent. Owns no geometry.
struct LateSplitBvh {
  LateSplitNode root;
  std::vector<LateSplitPair> pairs;
  std::vector<LeafSlot> slots;  ///< one for each leaf of the standard tree; none: there is nothing to hit

  bool is_empty() const { return slots.empty(); }
  size_t bytes() const { return pairs.size() * sizeof(LateSplitPair) + slots.size() * sizeof(LeafSlot); }
};

/// Equal for equal trees.
uint64_t tree_hash(const LateSplitBvh& tree);

/// What is wrong with the tree, if anything: a box that is empty or reaches out of its parent's, a pair or slot reached
/// twice or never or by the wrong kind of node, a path longer than kMaxDepth, a slot that names no primitive.
std::optional<std::string> find_fault(const LateSplitBvh& tree, std::span<const Geometry> geometries);

}  // namespace kerf
