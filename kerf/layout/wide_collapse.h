#pragma once

#include <array>
#include <vector>

#include "kerf/base/work_limit.h"
#include "kerf/layout/triangle_leaf.h"
#include "kerf/layout/wide_costs.h"
#include "kerf/tree/bvh.h"

namespace kerf {

/// Which nodes of a binary tree become nodes and leaves of a wide one: of all ways the one that the surface area
/// heuristic finds cheapest, by dynamic programming over forests (Ylitie, Karras, Laine: Efficient Incoherent Ray
/// Traversal on GPUs Through Compressed Wide BVHs, 2017, section 3.1; theirs is for one kind of leaf). Subtrees of
/// triangles may become one leaf. Parallel; the outcome does not depend on the number of threads.
class WideCollapse {
 public:
  static constexpr uint32_t kMostChildren = 8;
  using Children = std::array<uint32_t, kMostChildren>;

  /// Nodes and units that a layout's words can number.
  static constexpr uint32_t kMostNumbers = 1U << 28;

  /// Units of a leaf of triangles.
  using LeafUnits = size_t (*)(std::span<const LeafSlot> slots, std::span<const Geometry> geometries);

  /// The tree must have a node and outlive this. `width`: 2 to kMostChildren. Throws Error(too_large) where more than
  /// `most` nodes or units of leaves would be needed. `leaf_units`: TriangleLeaf's where there is none; and how the
  /// layout's name begins.
  WideCollapse(const Bvh& bvh, std::span<const Geometry> geometries, uint32_t width, const WideCosts& costs,
               uint32_t most = kMostNumbers, LeafUnits leaf_units = nullptr, const char* name = "bvh");

  /// What a binary node that is the root of a wide subtree becomes: a leaf, of triangles only or of any primitives, or
  /// an inner node.
  bool is_leaf(uint32_t node) const { return plans_[node].is_leaf(); }
  bool is_triangles(uint32_t node) const { return plans_[node].slots() > 0; }

  /// The children of what becomes an inner node, the largest first; returns how many.
  uint32_t children(uint32_t node, Children& children) const;

  /// The slots of what becomes a leaf, if of triangles each once; `few` is where they may stand.
  using FewSlots = std::array<LeafSlot, TriangleLeaf::kMost>;
  std::span<const LeafSlot> leaf_slots(uint32_t node, FewSlots& few) const;

  /// Wide nodes and units of leaves in a wide subtree.
  struct Size {
    uint32_t nodes = 0, units = 0;
  };
  Size size(uint32_t node) const { return plans_[node].size; }
  /// The cost of all, in visits of a node by a random ray that meets the root's box; 0 where that has no area.
  double cost() const { return cost_; }

  /// What is held of each binary node.
  static constexpr size_t kBytesPerNode = 12;

 private:
  /// Of the cheapest forest of at most i + 1 wide subtrees that a binary node becomes.
  using Costs = std::array<float, kMostChildren>;

  /// One binary node.
  class Plan {
   public:
    /// How many of i + 1 subtrees the first child gets; 0: as for one less.
    uint32_t first(uint32_t i) const { return word_ >> (3 * i) & 7; }
    void set_first(uint32_t i, uint32_t count) { word_ = (word_ & ~(7U << (3 * i))) | count << (3 * i); }
    /// Triangles, if there are only such and few enough for one leaf; else 0.
    uint32_t slots() const { return word_ >> kSlotsBit & 15; }
    void set_slots(uint32_t count) { word_ |= count << kSlotsBit; }
    /// Some of a leaf's slots stand elsewhere, too.
    bool is_repeated() const { return (word_ & kIsRepeated) != 0; }
    void set_repeated() { word_ |= kIsRepeated; }
    bool is_leaf() const { return (word_ & kIsLeaf) != 0; }
    void set_leaf() { word_ |= kIsLeaf; }

    Size size;

   private:
    static constexpr uint32_t kSlotsBit = 3 * kMostChildren, kIsLeaf = 1U << 28, kIsRepeated = 1U << 29;

    uint32_t word_ = 0;
  };
  static_assert(sizeof(Plan) == kBytesPerNode);

  Costs solve(uint32_t node, uint32_t depth);
  Costs solve_leaf(uint32_t node);
  Costs solve_inner(uint32_t node, const Costs& a, const Costs& b);
  void measure(uint32_t node, uint32_t depth);
  size_t units_of_leaf(uint32_t node) const;
  uint32_t gather(uint32_t node, FewSlots& slots, uint32_t count) const;
  void collect(uint32_t node, uint32_t most, Children& children, uint32_t& count) const;
  bool are_triangles(uint32_t node) const;

  const Bvh& bvh_;
  std::span<const Geometry> geometries_;
  uint32_t width_;
  WideCosts costs_;
  uint32_t most_;
  LeafUnits leaf_units_;
  const char* name_;
  bool only_triangles_ = false;  ///< in all geometries
  double scale_;                 ///< of areas: in shares of the root's
  double cost_ = 0;
  std::vector<Plan> plans_;
  HeldBytes held_;
};

}  // namespace kerf
