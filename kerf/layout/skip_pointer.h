#pragma once

#include <optional>
#include <vector>

#include "kerf/tree/bvh.h"
#include "kerf/tree/fragments.h"
#include "kerf/tree/refit_nodes.h"

namespace kerf {

/// One box of a SkipPointerBvh. 32 bytes.
struct SkipPointerNode {
  Vec3f lower;
  uint32_t first = 0;  ///< inner node: the node after its subtree; leaf: its first slot
  Vec3f upper;
  uint32_t count = 0;  ///< inner node: 0; leaf: its number of slots

  bool is_leaf() const { return count != 0; }
  Box3f bounds() const { return {lower, upper}; }
  /// The lower sides as floats 0 to 2, the upper ones as 4 to 6.
  const float* sides() const { return &lower.x; }
};
static_assert(sizeof(SkipPointerNode) == 32);

/// A Bvh in the order in which a ray visits it: each node is followed by its first child's subtree, then by its second
/// child's, and knows where the next node is when it is missed, so that no stack is needed (Smits: Efficiency Issues
/// for Ray Tracing, 1998).
struct SkipPointerBvh {
  std::vector<SkipPointerNode> nodes;
  std::vector<LeafSlot> slots;

  size_t bytes() const { return nodes.size() * sizeof(SkipPointerNode) + slots.size() * sizeof(LeafSlot); }
  /// The node after a node's subtree.
  uint32_t after(uint32_t node) const { return nodes[node].is_leaf() ? node + 1 : nodes[node].first; }
};

SkipPointerBvh make_skip_pointer_bvh(Bvh&& bvh);

/// Makes every box anew; see refit_nodes().
RefitOutcome refit(SkipPointerBvh& layout, const LeafParts& leaf_parts);

/// The same tree, its children in pairs; nothing where the pointers make no tree.
std::optional<Bvh> make_bvh(const SkipPointerBvh& layout);

/// What is wrong with it, if anything: pointers that make no tree, or what find_fault() of that tree says.
std::optional<std::string> find_fault(const SkipPointerBvh& layout, std::span<const Geometry> geometries,
                                      uint32_t largest_leaf);

}  // namespace kerf
