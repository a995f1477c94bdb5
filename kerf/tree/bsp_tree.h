#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kerf/base/box3.h"
#include "kerf/geometry/geometry.h"
#include "kerf/tree/bvh.h"

namespace kerf {

/// The points p with dot(normal, p) = offset. The numbers are exact: whatever they were rounded from, this is the
/// plane.
struct BspPlane {
  enum Kind : uint32_t { kAcrossX, kAcrossY, kAcrossZ, kOblique };

  Vec3f normal;  ///< of length 1, as nearly as float has it
  double offset = 0;

  /// The distance above the plane.
  double side(Vec3d p) const { return dot(to_double(normal), p) - offset; }

  Kind kind() const {
    return normal == Vec3f{1, 0, 0}   ? kAcrossX
           : normal == Vec3f{0, 1, 0} ? kAcrossY
           : normal == Vec3f{0, 0, 1} ? kAcrossZ
                                      : kOblique;
  }
};

/// A cell: cut by a plane into two, or a leaf. 32 bytes.
struct BspNode {
  static constexpr uint32_t kLeaf = 4;

  Vec3f normal;           ///< of the plane
  uint32_t first = 0;     ///< inner node: the cell below the plane, the one above follows; leaf: its first slot
  double offset = 0;      ///< of the plane
  uint32_t count = 0;     ///< leaf: its number of slots, 0 where there is nothing
  uint32_t kind = kLeaf;  ///< BspPlane::Kind or kLeaf

  bool is_leaf() const { return kind == kLeaf; }
  BspPlane plane() const { return {normal, offset}; }
  friend bool operator==(const BspNode&, const BspNode&) = default;
};
static_assert(sizeof(BspNode) == 32);

/// What a cell looks like: for study, rays do not need it.
struct BspCell {
  Box3f bounds;     ///< around the cell and the parts of primitives in it
  double area = 0;  ///< of the cell's surface, a convex polyhedron
};

/// A binary space partition as plain data. Node 0 is the root; children come after their parent, in pairs (1, 2), (3,
/// 4), ... A primitive stands in the leaf of every cell that it reaches. Owns no geometry.
struct BspTree {
  std::vector<BspNode> nodes;
  std::vector<BspCell> cells;  ///< one for each node
  std::vector<LeafSlot> slots;
  Box3f bounds;      ///< of everything
  double slack = 0;  ///< how far parts of primitives may lie beyond the planes of the leaves that have them

  size_t bytes() const { return nodes.size() * sizeof(BspNode) + slots.size() * sizeof(LeafSlot); }
};

/// Equal for equal trees.
uint64_t tree_hash(const BspTree& tree);

/// The surface area heuristic over the cells' polyhedra, see sah_cost(const Bvh&).
double sah_cost(const BspTree& tree);

/// What is wrong with the tree, if anything: a node or slot reached twice or never, a number out of range, a plane
/// whose normal is not of length 1 or not along its axis, a path longer than kMaxDepth, a cell's box that reaches out
/// of its parent's, a primitive twice in a leaf, and a primitive that can be hit but is missing, at one of some points
/// of it, from all leaves whose planes allow that point.
std::optional<std::string> find_fault(const BspTree& tree, std::span<const Geometry> geometries);

}  // namespace kerf
