#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kerf/tree/bvh.h"
#include "kerf/tree/cell_cut.h"

namespace kerf {

/// One cell of an octree. 8 bytes.
struct OctreeNode {
  static constexpr uint32_t kInner = 0x80000000U;

  uint32_t first = 0;  ///< inner node: the first of its children, which lie in a row; leaf: its first slot
  uint32_t bits = 0;   ///< inner node: kInner and a bit for each octant with a child; leaf: its number of slots

  bool is_leaf() const { return (bits & kInner) == 0; }
  /// Bit i is set if there is a child in octant i, whose bit a says whether it lies in the upper half along axis a.
  uint32_t octants() const { return bits & 0xFF; }
  friend bool operator==(const OctreeNode&, const OctreeNode&) = default;
};
static_assert(sizeof(OctreeNode) == 8);

/// Cells divided at their middle along all axes, or along two: a quadtree. Cells are closed and share their sides
/// exactly. What is empty is not there. Node 0 is the root; no nodes: there is nothing to hit. Owns no geometry.
struct Octree {
  static constexpr uint32_t kAllAxes = 7;

  Box3f bounds;              ///< of the root's cell, at least around all primitives
  uint32_t axes = kAllAxes;  ///< a bit for each axis along which cells are divided
  std::vector<OctreeNode> nodes;
  std::vector<LeafSlot> slots;  ///< of each leaf, by geometry, then primitive

  bool is_empty() const { return nodes.empty(); }
  size_t bytes() const { return nodes.size() * sizeof(OctreeNode) + slots.size() * sizeof(LeafSlot); }
};

/// Where a cell is divided along an axis; its upper side where it is not: the axis is not among `axes`, or no float
/// lies between its sides.
inline float division(float lower, float upper, uint32_t axis, uint32_t axes) {
  const float middle = 0.5F * lower + 0.5F * upper;
  return (axes >> axis & 1) != 0 && lower < middle && middle < upper ? middle : upper;
}

/// The cell of one octant of a cell.
Box3f octant_of(const Box3f& cell, uint32_t octant, uint32_t axes);

/// Calls emit(octant, box) for every octant of a cell that something within `whole` reaches into, with the box of what
/// lies there. What that is only `cut` knows: of what lies in a box it returns the CutBoxes at a plane that crosses it.
template <class Cut, class Emit>
void for_each_octant(const Box3f& cell, uint32_t axes, const Box3f& whole, Cut&& cut, Emit&& emit) {
  Box3f parts[8];
  parts[0] = whole;
  for (uint32_t axis = 0; axis < 3; ++axis) {
    const float position = division(cell.lower[axis], cell.upper[axis], axis, axes);
    if (position == cell.upper[axis]) continue;
    for (uint32_t below = 0; below < 1U << axis; ++below) {
      Box3f& part = parts[below];
      Box3f& above = parts[below | 1U << axis];
      if (part.is_empty() || part.upper[axis] <= position) {
        if (!part.is_empty() && part.lower[axis] == position) std::swap(part, above);  // flat, in the plane
      } else if (part.lower[axis] >= position) {
        std::swap(part, above);
      } else {
        const CutBoxes boxes = settled(cut(part, axis, position), part, axis, position);
        part = boxes.below;
        above = boxes.above;
      }
    }
  }
  for (uint32_t octant = 0; octant < 8; ++octant) {
    if (!parts[octant].is_empty()) emit(octant, parts[octant]);
  }
}

/// A number that is equal for equal trees, whatever the machine.
uint64_t tree_hash(const Octree& tree);

/// What is wrong with the tree, if anything: a node or slot reached twice or never, a number out of range, a path
/// longer than kMaxDepth, an empty leaf, a child along an axis that is not divided, a primitive missing in a leaf that
/// it reaches into or standing in one that its box does not touch, slots out of order, a wrong kRepeated.
std::optional<std::string> find_fault(const Octree& tree, std::span<const Geometry> geometries);

}  // namespace kerf
