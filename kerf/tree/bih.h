#pragma once

#include <bit>
#include <optional>
#include <string>
#include <vector>

#include "kerf/tree/bvh.h"

namespace kerf {

/// One node of a bounding interval hierarchy. 12 bytes.
struct BihNode {
  static constexpr uint32_t kLeaf = 3;

  uint32_t link = kLeaf;  ///< inner node: the number of its pair of children, times 4, plus its axis; leaf: kLeaf
  uint32_t words[2];      ///< inner node: the bits of its two clip planes; leaf: its first slot and its number of slots

  static BihNode inner(uint32_t pair, uint32_t axis, float left_end, float right_begin) {
    return {pair << 2 | axis, {std::bit_cast<uint32_t>(left_end), std::bit_cast<uint32_t>(right_begin)}};
  }
  static BihNode leaf(uint32_t first, uint32_t count) { return {kLeaf, {first, count}}; }

  bool is_leaf() const { return link == kLeaf; }
  uint32_t axis() const { return link & 3; }
  /// The left child; the right one stands after it.
  uint32_t child() const { return (link >> 2) * 2 + 1; }
  /// Where the left child (0) ends and where the right child (1) begins along the axis.
  float clip(uint32_t side) const { return std::bit_cast<float>(words[side]); }
  uint32_t first() const { return words[0]; }
  uint32_t count() const { return words[1]; }
  friend bool operator==(const BihNode&, const BihNode&) = default;
};
static_assert(sizeof(BihNode) == 12);

/// A bounding interval hierarchy as plain data (Waechter, Keller: Instant Ray Tracing: The Bounding Interval Hierarchy,
/// 2006): a node stores where its children end along one axis, no boxes, and the children may overlap. Node 0 is the
/// root; no nodes: there is nothing to hit. Children come after their parent, in pairs (1, 2), (3, 4), ... Owns no
/// geometry.
struct Bih {
  Box3f bounds;
  std::vector<BihNode> nodes;
  std::vector<LeafSlot> slots;

  bool is_empty() const { return nodes.empty(); }
  size_t bytes() const { return nodes.size() * sizeof(BihNode) + slots.size() * sizeof(LeafSlot); }
};

/// What is left of a node's box for its left child (0) or its right child (1).
inline Box3f clipped_by(const BihNode& node, Box3f box, uint32_t side) {
  (side == 0 ? box.upper : box.lower)[node.axis()] = node.clip(side);
  return box;
}

/// A number that is equal for equal trees, whatever the machine.
uint64_t tree_hash(const Bih& bih);

/// What is wrong with the tree, if anything: a node or slot reached twice or never, a number out of range, a path
/// longer than kMaxDepth, a clip plane outside its node, a primitive with one slot that reaches out of its leaf, one
/// with more whose parts in its leaves leave a side of it out, a wrong kRepeated.
std::optional<std::string> find_fault(const Bih& bih, std::span<const Geometry> geometries);

}  // namespace kerf
