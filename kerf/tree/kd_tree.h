#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "kerf/tree/bvh.h"

namespace kerf {

/// A cell that a plane divides, or a leaf. 8 bytes.
struct KdNode {
  static constexpr uint32_t kLeaf = 3;                   ///< stands where an inner node has its axis
  static constexpr uint32_t kMaxIndex = (1U << 30) - 1;  ///< the largest number of a node or slot

  uint32_t word = 0;            ///< inner node: the bits of the plane's position; leaf: its number of slots
  uint32_t index_bits = kLeaf;  ///< the axis or kLeaf in the lowest two bits, above them a number

  static KdNode inner(uint32_t axis, float plane, uint32_t above) {
    return {std::bit_cast<uint32_t>(plane), above << 2 | axis};
  }
  static KdNode leaf(uint32_t first, uint32_t count) { return {count, first << 2 | kLeaf}; }

  bool is_leaf() const { return axis() == kLeaf; }
  uint32_t axis() const { return index_bits & 3; }
  float plane() const { return std::bit_cast<float>(word); }
  /// Of an inner node: the child above the plane. The one below it is the next node.
  uint32_t above() const { return index_bits >> 2; }
  uint32_t count() const { return word; }
  uint32_t first() const { return index_bits >> 2; }

  friend bool operator==(const KdNode&, const KdNode&) = default;
};
static_assert(sizeof(KdNode) == 8);

/// A kd-tree as plain data. Cells are closed boxes that share their sides; a primitive stands in every leaf whose
/// inside it reaches, and one that only touches a plane in a leaf on one side of it. Nodes stand in depth-first order,
/// the child below its plane right after its parent, and slots in the order of their leaves. No nodes: nothing to hit.
/// Owns no geometry.
struct KdTree {
  Box3f bounds;  ///< the root's cell
  std::vector<KdNode> nodes;
  std::vector<LeafSlot> slots;

  bool is_empty() const { return nodes.empty(); }
  size_t bytes() const { return nodes.size() * sizeof(KdNode) + slots.size() * sizeof(LeafSlot); }
};

/// The part of a cell below or above a plane.
inline Box3f below_plane(Box3f cell, uint32_t axis, float plane) {
  cell.upper[axis] = plane;
  return cell;
}
inline Box3f above_plane(Box3f cell, uint32_t axis, float plane) {
  cell.lower[axis] = plane;
  return cell;
}

/// Calls visit(number, cell, depth) for every node, a parent before its children, in the order of their numbers.
template <class F>
void visit_cells(const KdTree& tree, F&& visit) {
  struct Place {
    uint32_t node;
    Box3f cell;
    uint32_t depth;
  };
  std::vector<Place> stack;
  if (!tree.is_empty()) stack.push_back({0, tree.bounds, 0});
  while (!stack.empty()) {
    const Place at = stack.back();
    stack.pop_back();
    visit(at.node, at.cell, at.depth);
    const KdNode& node = tree.nodes[at.node];
    if (node.is_leaf()) continue;
    stack.push_back({node.above(), above_plane(at.cell, node.axis(), node.plane()), at.depth + 1});
    stack.push_back({at.node + 1, below_plane(at.cell, node.axis(), node.plane()), at.depth + 1});
  }
}

/// Sets LeafSlot::kRepeated where a primitive stands in more than one slot, and nowhere else.
void mark_repeated(KdTree& tree, std::span<const Geometry> geometries);

/// A number that is equal for equal trees, whatever the machine: the bounds, every node and every slot count.
uint64_t tree_hash(const KdTree& tree);

/// What is wrong with the tree, if anything: a link, a node or slot out of order, a plane not inside its cell, a path
/// longer than `max_depth`, a slot that names no primitive, a primitive twice in a leaf, a wrong kRepeated; a primitive
/// that reaches into a leaf and does not stand in it, or the other way round, judged by cutting every primitive at
/// every plane on its way down. With `boxes_only` a leaf may have any primitive whose box it meets.
std::optional<std::string> find_fault(const KdTree& tree, std::span<const Geometry> geometries, bool boxes_only = false,
                                      uint32_t max_depth = kMaxDepth);

}  // namespace kerf
