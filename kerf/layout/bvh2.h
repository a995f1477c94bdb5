#pragma once

#include <cstddef>
#include <vector>

#include "kerf/tree/bvh.h"
#include "kerf/tree/fragments.h"
#include "kerf/tree/refit_nodes.h"

namespace kerf {

/// A child of a Bvh2Node: its box and where it is. 32 bytes.
struct Bvh2Child {
  Vec3f lower;
  uint32_t first = 0;  ///< inner node: its number; leaf: its first slot
  Vec3f upper;
  uint32_t count = 0;  ///< inner node: 0, or what mark_axes() wrote; leaf: its number of slots

  /// How mark_axes() writes an inner node's count: the mark, the axis, and a bit.
  static constexpr uint32_t kAxisMark = 0x80000000U, kAxis = 3, kSecondIsLower = 4;

  bool is_leaf() const { return count != 0 && (count & kAxisMark) == 0; }
  Box3f bounds() const { return {lower, upper}; }
  /// The lower sides as floats 0 to 2, the upper ones as 4 to 6.
  const float* sides() const { return &lower.x; }
};
static_assert(sizeof(Bvh2Child) == 32 && offsetof(Bvh2Child, upper) == 16);

/// An inner node with the boxes of both its children: one cache line of 64 bytes decides about both.
struct alignas(64) Bvh2Node {
  Bvh2Child child[2];
};
static_assert(sizeof(Bvh2Node) == 64);

/// The two-wide traversal layout of a Bvh.
struct Bvh2 {
  Bvh2Child root;  ///< an inner node or a single leaf; with no slots: nothing to hit
  std::vector<Bvh2Node> nodes;
  std::vector<LeafSlot> slots;

  bool is_empty() const { return slots.empty(); }
  size_t bytes() const { return nodes.size() * sizeof(Bvh2Node) + slots.size() * sizeof(LeafSlot); }
};

/// Takes the slots over, so that they are not held twice.
Bvh2 make_bvh2(Bvh&& bvh);

/// The tree that a layout was made from.
Bvh make_bvh(const Bvh2& layout);

/// Makes every box anew; see refit_nodes(). The marks of mark_axes() stay as they are.
RefitOutcome refit(Bvh2& layout, const LeafParts& leaf_parts);

/// Writes into the count of each inner node along which axis the centres of its children differ most, and whether the
/// second child is the lower one there: which comes first then follows from the sign of a ray's direction (Mahovsky:
/// Ray Tracing with Reduced-Precision Bounding Volume Hierarchies, 2005).
void mark_axes(Bvh2& layout);

/// A node whose count is not what mark_axes() writes, if there is one.
std::optional<std::string> find_axis_fault(const Bvh2& layout);

}  // namespace kerf
