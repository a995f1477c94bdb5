#include "kerf/tree/octree.h"

#include <algorithm>
#include <bit>

#include "kerf/tree/cell_slots.h"

namespace kerf {
namespace {

bool in_order(const LeafSlot& a, const LeafSlot& b) {
  return a.geometry() != b.geometry() ? a.geometry() < b.geometry() : a.primitive < b.primitive;
}

/// The walk over nodes and slots that says what is wrong with them.
class Check {
 public:
  Check(const Octree& tree, std::span<const Geometry> geometries)
      : tree_(tree), geometries_(geometries), node_seen_(tree.nodes.size()), slot_used_(tree.slots.size()) {}

  std::optional<std::string> run() {
    if (tree_.axes > Octree::kAllAxes) return "axes that do not exist";
    if (std::string fault = visit(0, tree_.bounds, 0); !fault.empty()) return fault;
    if (std::find(node_seen_.begin(), node_seen_.end(), false) != node_seen_.end()) return "a node nothing leads to";
    if (std::find(slot_used_.begin(), slot_used_.end(), false) != slot_used_.end()) return "a slot in no leaf";
    return std::nullopt;
  }

 private:
  std::string visit(uint32_t number, const Box3f& cell, uint32_t depth) {
    const OctreeNode& node = tree_.nodes[number];
    const std::string name = "node " + std::to_string(number);
    if (node_seen_[number]) return name + " is reached twice";
    if (depth > kMaxDepth) return name + " is deeper than " + std::to_string(kMaxDepth);
    node_seen_[number] = true;
    if (node.is_leaf()) {
      const std::string fault = visit_leaf(node, cell);
      return fault.empty() ? fault : name + fault;
    }
    const uint32_t octants = node.octants();
    const auto count = static_cast<uint32_t>(std::popcount(octants));
    if (count == 0) return name + " has no children";
    if (node.first <= number || node.first + size_t{count} > tree_.nodes.size())
      return name + " has children elsewhere";
    uint32_t child = node.first;
    for (uint32_t octant = 0; octant < 8; ++octant) {
      if ((octants >> octant & 1) == 0) continue;
      for (uint32_t a = 0; a < 3; ++a) {
        const bool divided = division(cell.lower[a], cell.upper[a], a, tree_.axes) < cell.upper[a];
        if ((octant >> a & 1) != 0 && !divided) return name + " has a child across an axis that is not divided";
      }
      std::string fault = visit(child++, octant_of(cell, octant, tree_.axes), depth + 1);
      if (!fault.empty()) return fault;
    }
    return {};
  }

  std::string visit_leaf(const OctreeNode& node, const Box3f& cell) {
    if (node.bits == 0) return " is empty";
    if (node.first + size_t{node.bits} > tree_.slots.size()) return " has slots out of range";
    for (uint32_t s = node.first; s < node.first + node.bits; ++s) {
      if (slot_used_[s]) return " uses a slot of another leaf";
      slot_used_[s] = true;
      const LeafSlot& slot = tree_.slots[s];
      const Box3f box = primitive_bounds(geometries_[slot.geometry()], slot.primitive);
      if (intersected(box, cell).is_empty()) return " holds a primitive that is elsewhere";
      if (s > node.first && !in_order(tree_.slots[s - 1], slot)) return " has slots out of order";
    }
    return {};
  }

  const Octree& tree_;
  std::span<const Geometry> geometries_;
  std::vector<bool> node_seen_, slot_used_;
};

/// Whether the primitive, which takes up `box` of the cell, stands in every leaf below the node that it reaches into.
bool is_complete(const Octree& tree, const Geometry& geometry, const LeafSlot& wanted, uint32_t number,
                 const Box3f& cell, const Box3f& box) {
  const OctreeNode& node = tree.nodes[number];
  if (node.is_leaf()) {
    const auto begin = tree.slots.begin() + node.first;
    return std::binary_search(begin, begin + node.bits, wanted, in_order);
  }
  const auto cut = [&](const Box3f& part, uint32_t axis, float position) {
    const CutBoxes parts = halves(part, axis, position);
    return CutBoxes{clipped_bounds(geometry, wanted.primitive, parts.below),
                    clipped_bounds(geometry, wanted.primitive, parts.above)};
  };
  bool complete = true;
  for_each_octant(cell, tree.axes, box, cut, [&](uint32_t octant, const Box3f& part) {
    const uint32_t bit = 1U << octant;
    const uint32_t child = node.first + static_cast<uint32_t>(std::popcount(node.octants() & (bit - 1)));
    complete = complete && (node.octants() & bit) != 0 &&
               is_complete(tree, geometry, wanted, child, octant_of(cell, octant, tree.axes), part);
  });
  return complete;
}

}  // namespace

Box3f octant_of(const Box3f& cell, uint32_t octant, uint32_t axes) {
  Box3f result = cell;
  for (uint32_t a = 0; a < 3; ++a) {
    ((octant >> a & 1) != 0 ? result.lower : result.upper)[a] = division(cell.lower[a], cell.upper[a], a, axes);
  }
  return result;
}

uint64_t tree_hash(const Octree& tree) {
  const std::span<const Box3f> bounds(&tree.bounds, 1);
  return data_hash(std::span(tree.nodes), data_hash(std::span(tree.slots), data_hash(bounds, tree.axes)));
}

std::optional<std::string> find_fault(const Octree& tree, std::span<const Geometry> geometries) {
  if (auto fault = find_slot_fault(tree.slots, geometries)) return fault;
  if (tree.is_empty()) return tree.slots.empty() ? std::nullopt : std::optional<std::string>("slots without nodes");
  if (auto fault = Check(tree, geometries).run()) return fault;
  for (uint32_t g = 0; g < geometries.size(); ++g) {
    for (uint32_t p = 0; p < primitive_count(geometries[g]); ++p) {
      if (find_defect(geometries[g], p) != Defect::none || is_degenerate(geometries[g], p)) continue;
      const Box3f box = primitive_bounds(geometries[g], p);
      const std::string name = "geometry " + std::to_string(g) + ", primitive " + std::to_string(p);
      if (!tree.bounds.contains(box)) return name + " reaches out of the tree";
      if (!is_complete(tree, geometries[g], {g, p}, 0, tree.bounds, box)) {
        return name + " is missing in a leaf that it reaches into";
      }
    }
  }
  return std::nullopt;
}

}  // namespace kerf
