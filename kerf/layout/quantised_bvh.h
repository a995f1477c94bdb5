#pragma once

#include <bit>
#include <cstddef>

#include "kerf/base/line_array.h"
#include "kerf/layout/quantised_leaf.h"
#include "kerf/layout/wide_costs.h"
#include "kerf/tree/bvh.h"

namespace kerf {

struct LeafNumbers;

/// Where a child of a QuantisedNode is: as WideChild, but a leaf's kind is the number of its corners. 4 bytes.
struct QuantisedChild {
  /// Kind 0: an inner node, by number. Kinds 1 to 24: a leaf of triangles with so many different corners, by the place
  /// of its QuantisedLeaf. kSlots: a leaf of any primitives, as WideChild has it.
  static constexpr uint32_t kKindBits = 5, kInner = 0, kSlots = 31;
  static constexpr uint32_t kEnd = 30;  ///< no child: what kernels put below those that wait
  static_assert(QuantisedLeaf::kMostCorners < kEnd);

  uint32_t word = 0;

  static QuantisedChild of(uint32_t kind, size_t number) { return {static_cast<uint32_t>(number) << kKindBits | kind}; }
  uint32_t kind() const { return word & ((1U << kKindBits) - 1); }
  uint32_t number() const { return word >> kKindBits; }
  bool is_leaf() const { return kind() != kInner; }
};

/// The boxes of up to eight children side by side, each side in ten bits (the idea: Ylitie, Karras, Laine: Efficient
/// Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs, 2017, section 3.2, who take eight): the steps from
/// where all boxes begin are in the mantissa of a float f between 1 and 2, and the side is base + f size. So nothing is
/// converted: a shift, a mask and the exponent of 1 make f. A side as float arithmetic makes it from that, in two
/// operations or one, is never inside the box that it stands for, whatever the size of numbers. Two cache lines.
struct alignas(64) QuantisedNode {
  static constexpr uint32_t kWidth = 8;
  static constexpr uint32_t kSideBits = 10, kMostSteps = (1U << kSideBits) - 1;
  /// Of each axis: where its bits stand in a word, and where in f.
  static constexpr uint32_t kPlaces[3] = {12, 2, 22}, kMantissaPlaces[3] = {12, 13, 13};
  static constexpr uint32_t kOne = 0x3F800000;

  float base[3];
  float size[3];      ///< 0 where all is flat
  uint32_t children;  ///< how many
  uint32_t unused;
  uint32_t sides[2][kWidth];  ///< the lower ones, then the upper ones
  QuantisedChild child[kWidth];

  static float in_mantissa(uint32_t axis, uint32_t steps) {
    return std::bit_cast<float>(kOne | steps << kMantissaPlaces[axis]);
  }
  float side_at(uint32_t axis, uint32_t steps) const { return base[axis] + in_mantissa(axis, steps) * size[axis]; }
  uint32_t steps(uint32_t axis, uint32_t upper, uint32_t i) const {
    return sides[upper][i] >> kPlaces[axis] & kMostSteps;
  }
  Box3f bounds(uint32_t i) const {
    Box3f box;
    for (uint32_t axis = 0; axis < 3; ++axis) {
      box.lower[axis] = side_at(axis, steps(axis, 0, i));
      box.upper[axis] = side_at(axis, steps(axis, 1, i));
    }
    return box;
  }
  bool has_child(uint32_t i) const { return i < children; }

  /// Of the first children, as tight as steps allow; the others are none.
  void set_bounds(std::span<const Box3f> boxes);
};
static_assert(sizeof(QuantisedNode) == 128);

/// A WideBvh<8> in about half the memory: boxes in ten bits a side, corners that triangles share.
struct QuantisedBvh {
  using Child = QuantisedChild;
  static constexpr uint32_t kChildren = QuantisedNode::kWidth;

  /// Nodes and units that its words can number.
  static constexpr uint32_t kMostNumbers = 1U << (32 - QuantisedChild::kKindBits);

  Box3f bounds;         ///< of the root
  QuantisedChild root;  ///< an inner node or a single leaf; with no units: nothing to hit
  CornerKind corner_kind = CornerKind::places;
  LineArray<QuantisedNode> nodes;
  LineArray<LeafUnit> leaves;

  bool is_empty() const { return leaves.size() == 0; }
  size_t bytes() const { return nodes.bytes() + leaves.bytes(); }

  QuantisedLeaf triangles(QuantisedChild leaf) const { return {leaves[leaf.number()].floats(), leaf.kind()}; }
  /// The slots of a leaf of any kind, and how many.
  uint32_t slot_count(QuantisedChild leaf) const {
    return leaf.kind() == QuantisedChild::kSlots ? std::bit_cast<uint32_t>(leaves[leaf.number()].values[0])
                                                 : triangles(leaf).count();
  }
  std::vector<LeafSlot> slots(QuantisedChild leaf) const;
  void read_slots(QuantisedChild leaf, std::vector<LeafSlot>& to) const;
  /// Writes a leaf of triangles, as they are now, or of any primitives, from a unit on.
  QuantisedChild write_leaf(std::span<const LeafSlot> slots, bool is_triangles, std::span<const Geometry> geometries,
                            size_t unit);
};

/// As make_wide_bvh<8>(), from the same collapse; Error(too_large) comes from 2 GB of leaves on. `kind`: vertices for a
/// layout that is to be refitted.
QuantisedBvh make_quantised_bvh(const Bvh& bvh, std::span<const Geometry> geometries, const WideCosts& costs = {},
                                CornerKind kind = CornerKind::places, LeafNumbers* numbers = nullptr);

/// What is wrong with it, if anything: a side that is not where its child's box ends, a primitive that has one slot and
/// reaches out of a box above it, steps larger than they need be, a node or leaf reached twice or never or out of
/// order, a path longer than kMaxDepth, a gap between children, a leaf whose triangles are not the caller's.
std::optional<std::string> find_fault(const QuantisedBvh& layout, std::span<const Geometry> geometries);

/// Equal for equal trees, whatever the machine.
uint64_t tree_hash(const QuantisedBvh& layout);

}  // namespace kerf
