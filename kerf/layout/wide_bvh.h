#pragma once

#include <bit>
#include <cstddef>

#include "kerf/base/line_array.h"
#include "kerf/layout/triangle_leaf.h"
#include "kerf/layout/wide_costs.h"
#include "kerf/tree/bvh.h"

namespace kerf {

struct LeafNumbers;

/// Where a child of a wide node is: its kind in the low four bits, above them a number. 4 bytes.
struct WideChild {
  /// Kind 0: an inner node, by number. Kinds 1 to 8: a leaf of so many triangles, by the place of its TriangleLeaf.
  /// kSlots: a leaf of any primitives, by the place of its slots, which follow a unit that begins with their number.
  static constexpr uint32_t kKindBits = 4, kInner = 0, kSlots = 9;
  static constexpr uint32_t kEnd = 15;  ///< no child: what kernels put below those that wait

  uint32_t word = 0;

  static WideChild of(uint32_t kind, size_t number) { return {static_cast<uint32_t>(number) << kKindBits | kind}; }
  uint32_t kind() const { return word & ((1U << kKindBits) - 1); }
  uint32_t number() const { return word >> kKindBits; }
  bool is_leaf() const { return kind() != kInner; }
};

/// The boxes of up to so many children side by side. A place without a child has a box that no ray enters, infinite
/// and inside out; such places come last.
template <uint32_t kWidth>
struct alignas(64) WideNode {
  float sides[3][2][kWidth];  ///< for each axis the lower sides of all children, then the upper ones
  WideChild child[kWidth];

  Box3f bounds(uint32_t i) const {
    return {{sides[0][0][i], sides[1][0][i], sides[2][0][i]}, {sides[0][1][i], sides[1][1][i], sides[2][1][i]}};
  }
  void set_bounds(uint32_t i, const Box3f& box) {
    for (uint32_t axis = 0; axis < 3; ++axis) {
      sides[axis][0][i] = box.lower[axis];
      sides[axis][1][i] = box.upper[axis];
    }
  }
  bool has_child(uint32_t i) const { return sides[0][0][i] <= sides[0][1][i]; }

  /// Of the first children; the others are none.
  void set_bounds(std::span<const Box3f> boxes);
};
static_assert(sizeof(WideNode<4>) == 128 && sizeof(WideNode<8>) == 256);

/// A tree of nodes with up to kWidth children, made from a Bvh: the cheapest collapse by the surface area heuristic,
/// the leaves' primitives beside each other as the kernels read them. In depth-first order, larger children first. Its
/// triangles are copies: queries read none of the caller's vertices.
template <uint32_t kWidth>
struct WideBvh {
  using Child = WideChild;
  static constexpr uint32_t kChildren = kWidth;

  Box3f bounds;    ///< of the root
  WideChild root;  ///< an inner node or a single leaf; with no units: nothing to hit
  LineArray<WideNode<kWidth>> nodes;
  LineArray<LeafUnit> leaves;

  bool is_empty() const { return leaves.size() == 0; }
  size_t bytes() const { return nodes.bytes() + leaves.bytes(); }

  TriangleLeaf triangles(WideChild leaf) const { return {leaves[leaf.number()].floats(), leaf.kind()}; }
  /// The slots of a leaf of any kind, and how many.
  uint32_t slot_count(WideChild leaf) const {
    return leaf.kind() == WideChild::kSlots ? std::bit_cast<uint32_t>(leaves[leaf.number()].values[0]) : leaf.kind();
  }
  std::vector<LeafSlot> slots(WideChild leaf) const;
  void read_slots(WideChild leaf, std::vector<LeafSlot>& to) const;
  /// Writes a leaf of triangles, as they are now, or of any primitives, from a unit on.
  WideChild write_leaf(std::span<const LeafSlot> slots, bool is_triangles, std::span<const Geometry> geometries,
                       size_t unit);
};

/// Primitives that stand in a leaf twice are kept once. Throws Error(too_large) above 2^28 nodes or 4 GB of
/// leaves, and what the current limit does. `numbers`: where given, gets number_leaves().
template <uint32_t kWidth>
WideBvh<kWidth> make_wide_bvh(const Bvh& bvh, std::span<const Geometry> geometries, const WideCosts& costs = {},
                              LeafNumbers* numbers = nullptr);

/// What is wrong with it, if anything: a box that is not around its children, a primitive that has one slot and
/// reaches out of its leaf's box, a node or leaf reached twice or never or out of order, a path longer than kMaxDepth,
/// a gap between children, a leaf whose triangles are not the caller's.
template <uint32_t kWidth>
std::optional<std::string> find_fault(const WideBvh<kWidth>& layout, std::span<const Geometry> geometries);

/// Equal for equal trees, whatever the machine.
template <uint32_t kWidth>
uint64_t tree_hash(const WideBvh<kWidth>& layout);

}  // namespace kerf
