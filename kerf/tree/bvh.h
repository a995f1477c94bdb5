#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "kerf/base/box3.h"
#include "kerf/geometry/geometry.h"

namespace kerf {

/// No tree is deeper than this (the root alone has depth 0), so a traversal stack of this size cannot overflow.
inline constexpr uint32_t kMaxDepth = 64;

/// A place in a leaf: which primitive to test. 8 bytes.
struct LeafSlot {
  /// Marks a primitive that has more than one reference in the tree: only those need a check for repeats.
  static constexpr uint32_t kRepeated = 0x80000000U;

  uint32_t geometry_bits = 0;
  uint32_t primitive = 0;

  uint32_t geometry() const { return geometry_bits & ~kRepeated; }
  bool is_repeated() const { return (geometry_bits & kRepeated) != 0; }
  friend bool operator==(const LeafSlot&, const LeafSlot&) = default;
};
static_assert(sizeof(LeafSlot) == 8);

/// One box of the tree. 32 bytes.
struct BvhNode {
  Vec3f lower;
  uint32_t first = 0;  ///< inner node: its children are nodes first and first + 1; leaf: its first slot
  Vec3f upper;
  uint32_t count = 0;  ///< inner node: 0; leaf: its number of slots

  bool is_leaf() const { return count != 0; }
  Box3f bounds() const { return {lower, upper}; }
  friend bool operator==(const BvhNode&, const BvhNode&) = default;
};
static_assert(sizeof(BvhNode) == 32);

/// A binary bounding volume hierarchy as plain data: what every builder makes and every layout is made from.
/// Node 0 is the root; no nodes: there is nothing to hit. Children come after their parent, in pairs (1, 2), (3, 4),
/// ... Owns no geometry.
struct Bvh {
  std::vector<BvhNode> nodes;
  std::vector<LeafSlot> slots;

  size_t bytes() const { return nodes.size() * sizeof(BvhNode) + slots.size() * sizeof(LeafSlot); }
};

/// What a tree looks like.
struct BvhStatistics {
  size_t nodes = 0, leaves = 0;
  uint32_t depth = 0;         ///< edges from the root to the deepest leaf
  uint32_t largest_leaf = 0;  ///< slots
  double sah_cost = 0;        ///< see sah_cost()
};
BvhStatistics measure(const Bvh& bvh);

/// The surface area heuristic (Goldsmith and Salmon 1987; MacDonald and Booth 1990): the sum over nodes of area / area
/// of the root, times 1 for an inner node and times the number of slots for a leaf. 0 for an empty tree. Leaves and
/// inner nodes cost as given.
double sah_cost(const Bvh& bvh, double inner_cost = 1, double primitive_cost = 1);

/// A number that is equal for equal trees, whatever the machine: every node and slot counts.
uint64_t tree_hash(const Bvh& bvh);

/// Sets LeafSlot::kRepeated where a primitive stands in more than one slot, and nowhere else.
void mark_repeated(Bvh& bvh, std::span<const Geometry> geometries);

/// What is wrong with the tree, if anything: a child outside its parent's box, a node or slot reached twice or never, a
/// number out of range, a leaf above `largest_leaf` slots, a path longer than `max_depth`, a wrong kRepeated.
std::optional<std::string> find_fault(const Bvh& bvh, std::span<const Geometry> geometries, uint32_t largest_leaf,
                                      uint32_t max_depth = kMaxDepth);

}  // namespace kerf
