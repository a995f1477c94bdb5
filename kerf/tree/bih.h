#pragma once

#include <bit>
#include <optional>
#include <string>
#include <vector>

#include "kerf/tree/bvh.h"

namespace kerf {

/// One node of a bounding interval hierarchy. 12 bytes.
struct BihNode {
  static constexpr uint32_t kLeaf = 3, kSingle = 4, kLinkShift = 3;
  static constexpr size_t kMostNodes = size_t{1} << (32 - kLinkShift);

  uint32_t link = kLeaf;  ///< its first child, shifted; kSingle if that is the only one; its axis, or kLeaf
  uint32_t words[2];      ///< inner node: the bits of its two clip planes; leaf: its first slot and its number of slots

  static BihNode pair(uint32_t child, uint32_t axis, float left_end, float right_begin) {
    return {child << kLinkShift | axis, {std::bit_cast<uint32_t>(left_end), std::bit_cast<uint32_t>(right_begin)}};
  }
  static BihNode single(uint32_t child, uint32_t axis, float begin, float end) {
    return {child << kLinkShift | kSingle | axis, {std::bit_cast<uint32_t>(begin), std::bit_cast<uint32_t>(end)}};
  }
  static BihNode leaf(uint32_t first, uint32_t count) { return {kLeaf, {first, count}}; }

  bool is_leaf() const { return (link & 3) == kLeaf; }
  bool is_single() const { return (link & kSingle) != 0; }
  uint32_t axis() const { return link & 3; }
  /// The only child or the left one; the right one stands after it.
  uint32_t child() const { return link >> kLinkShift; }
  uint32_t children() const { return is_leaf() ? 0 : is_single() ? 1 : 2; }
  /// Of a pair: where the left child (0) ends and where the right child (1) begins along the axis; of a single child:
  /// where it begins (0) and where it ends (1).
  float clip(uint32_t side) const { return std::bit_cast<float>(words[side]); }
  uint32_t first() const { return words[0]; }
  uint32_t count() const { return words[1]; }
  friend bool operator==(const BihNode&, const BihNode&) = default;
};
static_assert(sizeof(BihNode) == 12);

/// A bounding interval hierarchy as plain data (Waechter, Keller: Instant Ray Tracing: The Bounding Interval Hierarchy,
/// 2006): no boxes, a node stores where its two children end along one axis, and they may overlap. Ours may also store
/// where an only child begins and ends, which cuts off empty space that pairs leave in along the other axes. Node 0 is
/// the root; no nodes: there is nothing to hit. Children come after their parent. Owns no geometry.
struct Bih {
  Box3f bounds;
  std::vector<BihNode> nodes;
  std::vector<LeafSlot> slots;

  bool is_empty() const { return nodes.empty(); }
  size_t bytes() const { return nodes.size() * sizeof(BihNode) + slots.size() * sizeof(LeafSlot); }
};

/// What a node leaves of its box for its left or only child (0), or for its right child (1).
inline Box3f clipped_by(const BihNode& node, Box3f box, uint32_t side) {
  const uint32_t axis = node.axis();
  if (node.is_single()) {
    box.lower[axis] = node.clip(0);
    box.upper[axis] = node.clip(1);
  } else {
    (side == 0 ? box.upper : box.lower)[axis] = node.clip(side);
  }
  return box;
}

/// A number that is equal for equal trees, whatever the machine.
uint64_t tree_hash(const Bih& bih);

/// What is wrong with the tree, if anything: a node or slot reached twice or never, a number out of range, a path
/// longer than kMaxDepth, a clip plane outside its node, a primitive with one slot that reaches out of its leaf, one
/// with more whose parts in its leaves leave a side of it out, a wrong kRepeated.
std::optional<std::string> find_fault(const Bih& bih, std::span<const Geometry> geometries);

}  // namespace kerf
