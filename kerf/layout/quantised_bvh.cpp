#include "kerf/layout/quantised_bvh.h"

#include <algorithm>
#include <cmath>

#include "kerf/base/rounding.h"
#include "kerf/layout/wide_check.h"
#include "kerf/layout/wide_writer.h"
#include "kerf/tree/hash_values.h"

namespace kerf {
namespace {

constexpr uint32_t kMostSteps = QuantisedNode::kMostSteps;

/// Where a side is before it is rounded to float.
double exact_side(const QuantisedNode& node, uint32_t axis, uint32_t steps) {
  const double f = QuantisedNode::in_mantissa(axis, steps);
  return static_cast<double>(node.base[axis]) + f * static_cast<double>(node.size[axis]);
}

bool is_below(const QuantisedNode& node, uint32_t axis, uint32_t steps, float side) {
  return exact_side(node, axis, steps) <= side && node.side_at(axis, steps) <= side;
}
bool is_above(const QuantisedNode& node, uint32_t axis, uint32_t steps, float side) {
  return exact_side(node, axis, steps) >= side && node.side_at(axis, steps) >= side;
}

/// How many steps it is to a side, in no whole number.
double steps_to(const QuantisedNode& node, uint32_t axis, float side) {
  const double f = (static_cast<double>(side) - static_cast<double>(node.base[axis])) / node.size[axis];
  const double step = static_cast<double>(QuantisedNode::in_mantissa(axis, 1)) - 1;
  return std::clamp<double>((f - 1) / step, 0, kMostSteps);
}

/// Makes the steps along an axis as small as they can be for sides from `lower` to `upper`.
void set_steps(QuantisedNode& node, uint32_t axis, float lower, float upper) {
  node.base[axis] = lower;
  node.size[axis] = 0;
  if (lower == upper) return;
  const double widest = static_cast<double>(QuantisedNode::in_mantissa(axis, kMostSteps)) - 1;
  double size = (static_cast<double>(upper) - static_cast<double>(lower)) / widest;
  // More where floats are too coarse for it: by one of the larger side's last places, then by twice that.
  double more = 0x1p-24 * std::max({std::abs(static_cast<double>(lower)), std::abs(static_cast<double>(upper)), size});
  do {
    node.size[axis] = round_up(size);
    node.base[axis] = round_down(static_cast<double>(lower) - static_cast<double>(node.size[axis]));
    while (!is_below(node, axis, 0, lower)) node.base[axis] = next_below(node.base[axis]);
    size += more;
    more = std::max(2 * more, 0x1p-149);
  } while (!is_above(node, axis, kMostSteps, upper));
}

/// The most steps that do not go beyond `lower`.
uint32_t lower_steps(const QuantisedNode& node, uint32_t axis, float lower) {
  if (node.size[axis] == 0) return 0;
  auto steps = static_cast<uint32_t>(steps_to(node, axis, lower));
  while (steps < kMostSteps && is_below(node, axis, steps + 1, lower)) ++steps;
  while (steps > 0 && !is_below(node, axis, steps, lower)) --steps;
  return steps;
}

/// The fewest that reach `upper`.
uint32_t upper_steps(const QuantisedNode& node, uint32_t axis, float upper) {
  if (node.size[axis] == 0) return 0;
  auto steps = static_cast<uint32_t>(std::ceil(steps_to(node, axis, upper)));
  while (steps > 0 && is_above(node, axis, steps - 1, upper)) --steps;
  while (steps < kMostSteps && !is_above(node, axis, steps, upper)) ++steps;
  return steps;
}

size_t units_of_places(std::span<const LeafSlot> slots, std::span<const Geometry> geometries) {
  return quantised_leaf_size(slots, geometries, CornerKind::places).units;
}
size_t units_of_vertices(std::span<const LeafSlot> slots, std::span<const Geometry> geometries) {
  return quantised_leaf_size(slots, geometries, CornerKind::vertices).units;
}

/// Lower sides are no lower than the larger of both, upper ones no higher than the smaller.
double least_above(const QuantisedNode& node, uint32_t axis, uint32_t steps) {
  return std::max<double>(exact_side(node, axis, steps), node.side_at(axis, steps));
}
double most_below(const QuantisedNode& node, uint32_t axis, uint32_t steps) {
  return std::min<double>(exact_side(node, axis, steps), node.side_at(axis, steps));
}

/// Between what numbers the box of what a node holds begins and ends along an axis, as far as its children's steps
/// tell.
struct Ends {
  double lower_least = Box3f::kInfinity, lower_most = Box3f::kInfinity;
  double upper_least = -Box3f::kInfinity, upper_most = -Box3f::kInfinity;

  Ends(const QuantisedNode& node, uint32_t axis) {
    for (uint32_t i = 0; i < QuantisedNode::kWidth && node.has_child(i); ++i) {
      const uint32_t first = node.steps(axis, 0, i), last = node.steps(axis, 1, i);
      lower_least = std::min(lower_least, least_above(node, axis, first));
      lower_most = std::min(lower_most, least_above(node, axis, std::min(first + 1, kMostSteps)));
      upper_least = std::max(upper_least, most_below(node, axis, std::max(last, 1U) - 1));
      upper_most = std::max(upper_most, most_below(node, axis, last));
    }
  }
};

/// See WideCheck.
struct Rules {
  static Box3f box_of(const Box3f& box, const Box3f& child) { return intersected(box, child); }

  /// Every child's box ends where that of the node below says, and steps are no larger than it takes.
  static bool is_around(const QuantisedBvh& layout, const QuantisedNode& node, const Box3f& box) {
    if (node.children < 1 || node.children > QuantisedNode::kWidth) return false;
    for (uint32_t axis = 0; axis < 3; ++axis) {
      const Ends ends(node, axis);
      if (box.lower[axis] > ends.lower_most || box.upper[axis] < ends.upper_least) return false;
      if (!has_least_steps(node, axis)) return false;
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
    constexpr float kSlack = 1.01F;  // the sides that are known may be a step too far out
    Box3f box;
    for (uint32_t i = 0; i < QuantisedNode::kWidth && node.has_child(i); ++i) box.extend(node.bounds(i));
    QuantisedNode again;
    set_steps(again, axis, box.lower[axis], box.upper[axis]);
    return node.size[axis] <= kSlack * again.size[axis];
  }

  static bool fits(const QuantisedNode& node, uint32_t i, uint32_t axis, const QuantisedNode& below) {
    const uint32_t first = node.steps(axis, 0, i), last = node.steps(axis, 1, i);
    const Ends ends(below, axis);
    return least_above(node, axis, first) <= ends.lower_most && most_below(node, axis, last) >= ends.upper_least &&
           (first == kMostSteps || least_above(node, axis, first + 1) >= ends.lower_least) &&
           (last == 0 || most_below(node, axis, last - 1) <= ends.upper_most);
  }
};

}  // namespace

void QuantisedNode::set_bounds(std::span<const Box3f> boxes) {
  Box3f all;
  for (const Box3f& box : boxes) all.extend(box);
  children = static_cast<uint32_t>(boxes.size());
  for (uint32_t i = 0; i < kWidth; ++i) sides[0][i] = sides[1][i] = 0;
  for (uint32_t axis = 0; axis < 3; ++axis) {
    set_steps(*this, axis, all.lower[axis], all.upper[axis]);
    for (uint32_t i = 0; i < boxes.size(); ++i) {
      sides[0][i] |= lower_steps(*this, axis, boxes[i].lower[axis]) << kPlaces[axis];
      sides[1][i] |= upper_steps(*this, axis, boxes[i].upper[axis]) << kPlaces[axis];
    }
  }
}

void QuantisedBvh::read_slots(QuantisedChild leaf, std::vector<LeafSlot>& to) const {
  if (leaf.kind() == QuantisedChild::kSlots) return kerf::read_slots(&leaves[leaf.number()], to);
  const QuantisedLeaf all = triangles(leaf);
  to.resize(all.count());
  for (uint32_t i = 0; i < to.size(); ++i) to[i] = all.slot(i);
}

std::vector<LeafSlot> QuantisedBvh::slots(QuantisedChild leaf) const {
  std::vector<LeafSlot> slots;
  read_slots(leaf, slots);
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
