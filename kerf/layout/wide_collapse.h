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

  /// The tree must have a node and outlive this. `width`: 2 to kMostChildren.
  WideCollapse(const Bvh& bvh, std::span<const Geometry> geometries, uint32_t width, const WideCosts& costs);

  /// What a binary node that is the root of a wide subtree becomes: a leaf, of triangles only or of any primitives, or
  /// an inner node.
  bool is_leaf(uint32_t node) const { return plans_[node].is_leaf; }
  bool is_triangles(uint32_t node) const { return plans_[node].slots > 0; }

  /// The children of what becomes an inner node, the largest first; returns how many.
  uint32_t children(uint32_t node, Children& children) const;

  /// The slots of what becomes a leaf, if of triangles each once; `few` is where they may stand.
  using FewSlots = std::array<LeafSlot, TriangleLeaf::kMost>;
  std::span<const LeafSlot> leaf_slots(uint32_t node, FewSlots& few) const;

  /// Wide nodes and units of leaves in a wide subtree.
  struct Size {
    uint64_t nodes = 0, units = 0;
  };
  Size size(uint32_t node) const { return plans_[node].size; }

 private:
  /// One binary node.
  struct Plan {
    std::array<float, kMostChildren> cost;     ///< of the cheapest forest of at most i + 1 wide subtrees
    std::array<uint8_t, kMostChildren> first;  ///< how many of these the first child gets; 0: as for one less
    uint8_t slots = 0;  ///< triangles, if there are only such and few enough for one leaf; else 0
    bool is_leaf = false;
    Size size;
  };

  void solve(uint32_t node, uint32_t depth);
  void solve_leaf(uint32_t node);
  void solve_inner(uint32_t node);
  void measure(uint32_t node, uint32_t depth);
  uint32_t gather(uint32_t node, FewSlots& slots, uint32_t count) const;
  void collect(uint32_t node, uint32_t most, Children& children, uint32_t& count) const;
  bool are_triangles(uint32_t node) const;

  const Bvh& bvh_;
  std::span<const Geometry> geometries_;
  uint32_t width_;
  WideCosts costs_;
  double scale_;  ///< of areas: in shares of the root's
  std::vector<Plan> plans_;
  HeldBytes held_;
};

}  // namespace kerf
