#include "kerf/layout/quantised_bvh.h"

#include <algorithm>
#include <cmath>

#include "kerf/layout/wide_check.h"
#include "kerf/layout/wide_writer.h"
#include "kerf/tree/hash_values.h"

namespace kerf {
namespace {

constexpr uint32_t kMostSteps = QuantisedNode::kMostSteps;

/// The smallest step with which a side as far away as `upper` can be reached.
uint8_t exponent_for(float lower, float upper) {
  if (lower == upper) return 0;
  const double extent = static_cast<double>(upper) - static_cast<double>(lower);
  QuantisedNode node;
  node.origin[0] = lower;
  constexpr int kBias = 127;
  node.exponents[0] = static_cast<uint8_t>(std::max(std::ilogb(extent / kMostSteps) + kBias, 1));
  while (node.side_at(0, kMostSteps) < upper) ++node.exponents[0];
  return node.exponents[0];
}

/// The most steps that do not go beyond `lower`.
uint8_t lower_steps(const QuantisedNode& node, uint32_t axis, float lower) {
  const double step = node.step(axis);
  if (step == 0) return 0;
  const double exact = (static_cast<double>(lower) - static_cast<double>(node.origin[axis])) / step;
  auto steps = static_cast<uint32_t>(std::clamp<double>(exact, 0, kMostSteps));
  while (steps < kMostSteps && node.side_at(axis, steps + 1) <= lower) ++steps;
  while (node.side_at(axis, steps) > lower) --steps;
  return static_cast<uint8_t>(steps);
}

/// The fewest that reach `upper`.
uint8_t upper_steps(const QuantisedNode& node, uint32_t axis, float upper) {
  const double step = node.step(axis);
  if (step == 0) return 0;
  const double exact = (static_cast<double>(upper) - static_cast<double>(node.origin[axis])) / step;
  auto steps = static_cast<uint32_t>(std::clamp<double>(exact, 0, kMostSteps));
  while (steps > 0 && node.side_at(axis, steps - 1) >= upper) --steps;
  while (node.side_at(axis, steps) < upper) ++steps;
  return static_cast<uint8_t>(steps);
}

size_t units_of_places(std::span<const LeafSlot> slots, std::span<const Geometry> geometries) {
  return quantised_leaf_size(slots, geometries, CornerKind::places).units;
}
size_t units_of_vertices(std::span<const LeafSlot> slots, std::span<const Geometry> geometries) {
  return quantised_leaf_size(slots, geometries, CornerKind::vertices).units;
}

/// Where along an axis the upper side of what a node holds is, as far as its children's steps tell: above `above`,
/// up to `most`.
struct UpperSide {
  float above, most;

  UpperSide(const QuantisedNode& node, uint32_t axis) : above(-Box3f::kInfinity), most(node.origin[axis]) {
    for (uint32_t i = 0; i < QuantisedNode::kWidth && node.has_child(i); ++i) {
      const uint32_t steps = node.sides[axis][1][i];
      if (steps > 0) above = std::max(above, node.side_at(axis, steps - 1));
      most = std::max(most, node.side_at(axis, steps));
    }
  }
};

/// See WideCheck.
struct Rules {
  static Box3f box_of(const Box3f& box, const Box3f& child) { return intersected(box, child); }

  /// Every child's box ends where that of the node below says; steps are no larger than it takes; the first is where
  /// the node begins.
  static bool is_around(const QuantisedBvh& layout, const QuantisedNode& node, const Box3f& box) {
    for (uint32_t axis = 0; axis < 3; ++axis) {
      if (!has_least_steps(node, axis) || box.lower[axis] > node.origin[axis]) return false;
      for (uint32_t i = 0; i < QuantisedNode::kWidth && node.has_child(i); ++i) {
        if (!node.child[i].is_leaf() && !fits(node, i, axis, layout.nodes[node.child[i].number()])) return false;
      }
    }
    return true;
  }

  static size_t leaf_units(const QuantisedBvh& layout, QuantisedChild leaf) {
    return leaf.kind() <= QuantisedLeaf::kMostCorners ? layout.triangles(leaf).units() : 0;
  }

  static bool is_written(const QuantisedBvh& layout, std::span<const Geometry> geometries, QuantisedChild leaf,
                         std::span<const LeafSlot> slots) {
    const auto is_mesh = [&](const LeafSlot& slot) {
      return std::holds_alternative<TriangleMesh>(geometries[slot.geometry()].shapes);
    };
    if (!std::all_of(slots.begin(), slots.end(), is_mesh)) return false;
    const QuantisedLeafSize size = quantised_leaf_size(slots, geometries, layout.corner_kind);
    if (size.corners != leaf.kind() || size.units != layout.triangles(leaf).units()) return false;
    std::vector<LeafUnit> expected(size.units, LeafUnit{});
    write_quantised_leaf(slots, geometries, layout.corner_kind, expected.data());
    return std::memcmp(expected.data(), &layout.leaves[leaf.number()], size.units * sizeof(LeafUnit)) == 0;
  }

 private:
  static bool has_least_steps(const QuantisedNode& node, uint32_t axis) {
    uint32_t first = kMostSteps;
    for (uint32_t i = 0; i < QuantisedNode::kWidth && node.has_child(i); ++i) {
      first = std::min<uint32_t>(first, node.sides[axis][0][i]);
      if (node.sides[axis][0][i] > node.sides[axis][1][i]) return false;
    }
    const float half = 0.5F * node.step(axis);
    return first == 0 && (node.exponents[axis] <= 1 ||
                          node.origin[axis] + static_cast<float>(kMostSteps) * half < UpperSide(node, axis).most);
  }

  static bool fits(const QuantisedNode& node, uint32_t i, uint32_t axis, const QuantisedNode& below) {
    const uint32_t first = node.sides[axis][0][i], last = node.sides[axis][1][i];
    if (first != lower_steps(node, axis, below.origin[axis])) return false;
    const UpperSide upper(below, axis);
    const float side = node.side_at(axis, last);
    return side > upper.above && side >= below.origin[axis] &&
           (last == 0 || node.side_at(axis, last - 1) < upper.most);
  }
};

}  // namespace

void QuantisedNode::set_bounds(std::span<const Box3f> boxes) {
  Box3f all;
  for (const Box3f& box : boxes) all.extend(box);
  places = static_cast<uint8_t>((1U << boxes.size()) - 1);
  for (uint32_t axis = 0; axis < 3; ++axis) {
    origin[axis] = all.lower[axis];
    exponents[axis] = exponent_for(all.lower[axis], all.upper[axis]);
    for (uint32_t i = 0; i < kWidth; ++i) {
      const bool has_box = i < boxes.size();
      sides[axis][0][i] = has_box ? lower_steps(*this, axis, boxes[i].lower[axis]) : static_cast<uint8_t>(kMostSteps);
      sides[axis][1][i] = has_box ? upper_steps(*this, axis, boxes[i].upper[axis]) : uint8_t{0};
    }
  }
}

std::vector<LeafSlot> QuantisedBvh::slots(QuantisedChild leaf) const {
  if (leaf.kind() == QuantisedChild::kSlots) return read_slots(&leaves[leaf.number()]);
  const QuantisedLeaf all = triangles(leaf);
  std::vector<LeafSlot> slots(all.count());
  for (uint32_t i = 0; i < slots.size(); ++i) slots[i] = all.slot(i);
  return slots;
}

QuantisedChild QuantisedBvh::write_leaf(std::span<const LeafSlot> slots, bool is_triangles,
                                        std::span<const Geometry> geometries, size_t unit) {
  if (!is_triangles) {
    write_slots(slots, &leaves[unit]);
    return QuantisedChild::of(QuantisedChild::kSlots, unit);
  }
  return QuantisedChild::of(write_quantised_leaf(slots, geometries, corner_kind, &leaves[unit]), unit);
}

QuantisedBvh make_quantised_bvh(const Bvh& bvh, std::span<const Geometry> geometries, const WideCosts& costs,
                                CornerKind kind, LeafNumbers* numbers) {
  QuantisedBvh layout;
  layout.corner_kind = kind;
  if (bvh.nodes.empty()) return layout;
  const WideCollapse collapse(bvh, geometries, QuantisedBvh::kChildren, costs, QuantisedBvh::kMostNumbers,
                              kind == CornerKind::places ? units_of_places : units_of_vertices, "quantised_bvh");
  write_wide(layout, bvh, geometries, collapse, numbers);
  return layout;
}

std::optional<std::string> find_fault(const QuantisedBvh& layout, std::span<const Geometry> geometries) {
  return WideCheck(layout, geometries, Rules()).run();
}

uint64_t tree_hash(const QuantisedBvh& layout) {
  if (layout.is_empty()) return 0;
  return hash_values(hash_values(layout.root.word, layout.nodes.span()), layout.leaves.span());
}

}  // namespace kerf
