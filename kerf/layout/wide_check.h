#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kerf/layout/wide_bvh.h"

namespace kerf {

/// Walks a wide layout and says what is wrong with it. What depends on the kind of its nodes and leaves is Rules:
/// node_fault(layout, node, bounds of the node itself), box_of(bounds of the node, child's bounds),
/// leaf_units(layout, leaf of triangles, units left), 0 if there is none, and is_written(layout, leaf, slots).
template <class Layout, class Rules>
class WideCheck {
 public:
  using Child = typename Layout::Child;

  WideCheck(const Layout& layout, std::span<const Geometry> geometries, const Rules& rules)
      : layout_(layout), geometries_(geometries), rules_(rules), is_reached_(layout.nodes.size()) {}

  std::optional<std::string> run() {
    if (layout_.is_empty()) {
      if (layout_.nodes.size() > 0) return "nodes without leaves";
      return std::nullopt;
    }
    visit(layout_.root, layout_.bounds, 0);
    if (fault_.empty() && reached_ != layout_.nodes.size()) fault_ = "some nodes are never reached";
    if (fault_.empty() && units_ + TriangleLeaf::kPadding != layout_.leaves.size()) fault_ = "some units in no leaf";
    return fault_.empty() ? std::nullopt : std::optional(fault_);
  }

 private:
  void visit(Child child, const Box3f& box, uint32_t depth) {
    if (!fault_.empty()) return;
    if (depth > kMaxDepth) {
      fault_ = "a path is too long";
      return;
    }
    if (child.is_leaf()) return visit_leaf(child, box);
    const uint32_t number = child.number();
    const std::string name = "node " + std::to_string(number);
    if (number >= layout_.nodes.size() || is_reached_[number]) {
      fault_ = name + (number >= layout_.nodes.size() ? " is not there" : " is reached twice");
      return;
    }
    is_reached_[number] = true;
    ++reached_;
    const auto& node = layout_.nodes[number];
    bool has_ended = false;
    for (uint32_t i = 0; i < Layout::kChildren; ++i) {
      if (!node.has_child(i)) {
        has_ended = true;
        continue;
      }
      if (has_ended) fault_ = name + " has a gap between its children";
      visit(node.child[i], rules_.box_of(box, node.bounds(i)), depth + 1);
    }
    if (fault_.empty() && !rules_.is_around(layout_, node, box)) {
      fault_ = name + " has a box that is not around its children";
    }
  }

  void visit_leaf(Child child, const Box3f& box) {
    const std::string name = "the leaf at unit " + std::to_string(child.number());
    const bool is_other = child.kind() == Child::kSlots;
    const size_t end = layout_.leaves.size() - TriangleLeaf::kPadding;
    size_t units = 0;
    if (child.number() == units_ && units_ < end) {
      units = is_other ? slots_units(layout_.slot_count(child)) : rules_.leaf_units(layout_, child);
    }
    if (units == 0 || units > end - units_) {
      fault_ = name + " is not where it should be";
      return;
    }
    units_ += units;
    const std::vector<LeafSlot> slots = layout_.slots(child);
    for (const LeafSlot& slot : slots) {
      if (slot.geometry() >= geometries_.size() || slot.primitive >= primitive_count(geometries_[slot.geometry()])) {
        fault_ = name + " names no primitive";
        return;
      }
      if (slot.is_repeated()) continue;
      if (!box.contains(primitive_bounds(geometries_[slot.geometry()], slot.primitive))) {
        fault_ = name + " has a primitive that reaches out of its box";
        return;
      }
    }
    if (!is_other && !rules_.is_written(layout_, geometries_, child, slots)) {
      fault_ = name + " has not the caller's triangles";
    }
  }

  const Layout& layout_;
  std::span<const Geometry> geometries_;
  const Rules& rules_;
  std::vector<bool> is_reached_;
  size_t reached_ = 0, units_ = 0;
  std::string fault_;
};

}  // namespace kerf
