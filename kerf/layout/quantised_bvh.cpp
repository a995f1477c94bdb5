#include "kerf/layout/quantised_bvh.h"

#include <algorithm>
#include <cmath>

#include "kerf/layout/wide_check.h"
#include "kerf/layout/wide_writer.h"
#include "kerf/tree/hash_values.h"

namespace kerf {
namespace {

constexpr uint32_t kMostSteps = QuantisedNode::kMostSteps;

/// Where a side is before it is rounded to float.
double exact_side(const QuantisedNode& node, uint32_t axis, uint32_t steps) {
  return static_cast<double>(node.origin[axis]) + steps * static_cast<double>(node.step(axis));
}

double steps_to(const QuantisedNode& node, uint32_t axis, float side) {
  const double way = static_cast<double>(side) - static_cast<double>(node.origin[axis]);
  return std::clamp<double>(way / static_cast<double>(node.step(axis)), 0, kMostSteps);
}

/// Makes the steps along an axis as small as they can be for sides from `lower` to `upper`.
void set_steps(QuantisedNode& node, uint32_t axis, float lower, float upper) {
  constexpr int kBias = 127;
  node.origin[axis] = lower;
  node.exponents[axis] = 0;
  if (lower == upper) return;
  const double extent = static_cast<double>(upper) - static_cast<double>(lower);
  node.exponents[axis] = static_cast<uint8_t>(std::max(std::ilogb(extent / kMostSteps) + kBias, 1));
  while (exact_side(node, axis, kMostSteps) < upper || node.side_at(axis, kMostSteps) < upper) ++node.exponents[axis];
}

/// The most steps that do not go beyond `lower`.
uint8_t lower_steps(const QuantisedNode& node, uint32_t axis, float lower) {
  if (node.exponents[axis] == 0) return 0;
  auto steps = static_cast<uint32_t>(std::floor(steps_to(node, axis, lower)));
  while (steps > 0 && node.side_at(axis, steps) > lower) --steps;  // where doubles were too short
  return static_cast<uint8_t>(steps);
}

/// The fewest that reach `upper`.
uint8_t upper_steps(const QuantisedNode& node, uint32_t axis, float upper) {
  if (node.exponents[axis] == 0) return 0;
  auto steps = static_cast<uint32_t>(std::ceil(steps_to(node, axis, upper)));
  while (steps < kMostSteps && node.side_at(axis, steps) < upper) ++steps;
  return static_cast<uint8_t>(steps);
}

size_t units_of_places(std::span<const LeafSlot> slots, std::span<const Geometry> geometries) {
  return quantised_leaf_size(slots, geometries, CornerKind::places).units;
}
size_t units_of_vertices(std::span<const LeafSlot> slots, std::span<const Geometry> geometries) {
  return quantised_leaf_size(slots, geometries, CornerKind::vertices).units;
}

/// Where along an axis the upper side of what a node holds is, as far as its children's steps tell.
struct UpperSide {
  double least, most;

  UpperSide(const QuantisedNode& node, uint32_t axis) : least(node.origin[axis]), most(node.origin[axis]) {
    for (uint32_t i = 0; i < QuantisedNode::kWidth && node.has_child(i); ++i) {
      const uint32_t steps = node.sides[axis][1][i];
      if (steps > 0) least = std::max(least, exact_side(node, axis, steps - 1));
      most = std::max(most, static_cast<double>(node.side_at(axis, steps)));
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
    if (node.exponents[axis] <= 1) return first == 0;
    QuantisedNode finer = node;
    --finer.exponents[axis];
    return first == 0 && exact_side(finer, axis, kMostSteps) <= UpperSide(node, axis).most;
  }

  static bool fits(const QuantisedNode& node, uint32_t i, uint32_t axis, const QuantisedNode& below) {
    const uint32_t first = node.sides[axis][0][i], last = node.sides[axis][1][i];
    const UpperSide upper(below, axis);
    return first == lower_steps(node, axis, below.origin[axis]) && node.side_at(axis, last) >= upper.least &&
           (last == 0 || exact_side(node, axis, last - 1) <= upper.most);
  }
};

}  // namespace

void QuantisedNode::set_bounds(std::span<const Box3f> boxes) {
  Box3f all;
  for (const Box3f& box : boxes) all.extend(box);
  places = static_cast<uint8_t>((1U << boxes.size()) - 1);
  for (uint32_t axis = 0; axis < 3; ++axis) {
    set_steps(*this, axis, all.lower[axis], all.upper[axis]);
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
