#include "kerf/layout/wide_bvh.h"

#include <bit>

#include "kerf/base/parallel.h"
#include "kerf/layout/wide_collapse.h"
#include "kerf/layout/wide_refit.h"
#include "kerf/tree/hash_values.h"

namespace kerf {
namespace {

constexpr uint32_t kTaskDepth = 5;

/// Writes the nodes and leaves of a collapse to where its sizes say, subtrees beside each other at once.
template <uint32_t kWidth>
class Writer {
 public:
  Writer(const Bvh& bvh, std::span<const Geometry> geometries, const WideCollapse& collapse, WideBvh<kWidth>& layout)
      : bvh_(bvh), geometries_(geometries), collapse_(collapse), layout_(layout) {}

  /// The wide subtree of a binary node, its nodes and its leaves' units from these numbers on.
  WideChild write(uint32_t node, size_t first_node, size_t first_unit, uint32_t depth) {
    if (collapse_.is_leaf(node)) return write_leaf(node, first_unit);
    WideCollapse::Children children;
    const uint32_t count = collapse_.children(node, children);
    WideNode<kWidth>& to = layout_.nodes[first_node];
    to = nobody();
    std::array<size_t, kWidth> nodes, units;
    size_t next_node = first_node + 1, next_unit = first_unit;
    for (uint32_t i = 0; i < count; ++i) {
      to.set_bounds(i, bvh_.nodes[children[i]].bounds());
      nodes[i] = next_node;
      units[i] = next_unit;
      next_node += collapse_.size(children[i]).nodes;
      next_unit += collapse_.size(children[i]).units;
    }
    const auto some = [&](uint32_t begin, uint32_t end) {
      for (uint32_t i = begin; i < end; ++i) to.child[i] = write(children[i], nodes[i], units[i], depth + 1);
    };
    if (depth < kTaskDepth) {
      parallel_invoke([&] { some(0, count / 2); }, [&] { some(count / 2, count); });
    } else {
      some(0, count);
    }
    return WideChild::of(WideChild::kInner, first_node);
  }

 private:
  static WideNode<kWidth> nobody() {
    WideNode<kWidth> node;
    for (auto& sides : node.sides) {
      std::fill_n(sides[0], kWidth, Box3f::kInfinity);
      std::fill_n(sides[1], kWidth, -Box3f::kInfinity);
    }
    return node;
  }

  WideChild write_leaf(uint32_t node, size_t first_unit) {
    WideCollapse::FewSlots few;
    const std::span<const LeafSlot> slots = collapse_.leaf_slots(node, few);
    LeafUnit* to = &layout_.leaves[first_unit];
    if (collapse_.is_triangles(node)) {
      write_triangle_leaf(slots, geometries_, to);
      return WideChild::of(static_cast<uint32_t>(slots.size()), first_unit);
    }
    to->values[0] = std::bit_cast<float>(static_cast<uint32_t>(slots.size()));
    std::memcpy(to + 1, slots.data(), slots.size_bytes());
    return WideChild::of(WideChild::kSlots, first_unit);
  }

  const Bvh& bvh_;
  std::span<const Geometry> geometries_;
  const WideCollapse& collapse_;
  WideBvh<kWidth>& layout_;
};

/// Walks a layout and says what is wrong with it.
template <uint32_t kWidth>
class Check {
 public:
  Check(const WideBvh<kWidth>& layout, std::span<const Geometry> geometries)
      : layout_(layout), geometries_(geometries), is_reached_(layout.nodes.size()) {}

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
  void visit(WideChild child, const Box3f& box, uint32_t depth) {
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
    const WideNode<kWidth>& node = layout_.nodes[number];
    Box3f all;
    bool has_ended = false;
    for (uint32_t i = 0; i < kWidth; ++i) {
      if (!node.has_child(i)) {
        has_ended = true;
        continue;
      }
      if (has_ended) fault_ = name + " has a gap between its children";
      all.extend(node.bounds(i));
      visit(node.child[i], node.bounds(i), depth + 1);
    }
    if (fault_.empty() && box != all) fault_ = name + " has a box that is not around its children";
  }

  void visit_leaf(WideChild child, const Box3f& box) {
    const std::string name = "the leaf at unit " + std::to_string(child.number());
    const bool is_other = child.kind() == WideChild::kSlots;
    const size_t end = layout_.leaves.size() - TriangleLeaf::kPadding;
    bool is_right = child.number() == units_ && units_ < end && (is_other || child.kind() <= TriangleLeaf::kMost);
    if (is_right) {
      const size_t count = is_other ? layout_.slot_count(child) : child.kind();
      units_ += is_other ? slots_units(count) : TriangleLeaf::units(count);
      is_right = units_ <= end;
    }
    if (!is_right) {
      fault_ = name + " is not where it should be";
      return;
    }
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
    if (is_other) return;
    std::vector<LeafUnit> expected(TriangleLeaf::units(slots.size()));
    write_triangle_leaf(slots, geometries_, expected.data());
    const size_t bytes = sizeof(float) * TriangleLeaf::kFloats * slots.size();
    if (std::memcmp(expected.data(), &layout_.leaves[child.number()], bytes) != 0) {
      fault_ = name + " has not the caller's triangles";
    }
  }

  const WideBvh<kWidth>& layout_;
  std::span<const Geometry> geometries_;
  std::vector<bool> is_reached_;
  size_t reached_ = 0, units_ = 0;
  std::string fault_;
};

}  // namespace

template <uint32_t kWidth>
std::vector<LeafSlot> WideBvh<kWidth>::slots(WideChild leaf) const {
  const LeafUnit* unit = &leaves[leaf.number()];
  const bool is_other = leaf.kind() == WideChild::kSlots;
  const size_t count = is_other ? slot_count(leaf) : leaf.kind();
  std::vector<LeafSlot> slots(count);
  const float* from = is_other ? unit[1].values : unit->values + 9 * count;
  std::memcpy(static_cast<void*>(slots.data()), from, count * sizeof(LeafSlot));
  return slots;
}

template <uint32_t kWidth>
WideBvh<kWidth> make_wide_bvh(const Bvh& bvh, std::span<const Geometry> geometries, const WideCosts& costs,
                              LeafNumbers* numbers) {
  WideBvh<kWidth> layout;
  if (bvh.nodes.empty()) return layout;
  const WideCollapse collapse(bvh, geometries, kWidth, costs);
  const WideCollapse::Size size = collapse.size(0);
  HeldBytes held_numbers;
  if (numbers != nullptr) {
    held_numbers.set((size.units / 2 + bvh.slots.size()) * sizeof(uint32_t));
    *numbers = number_leaves(bvh, collapse);
  }
  const HeldBytes held(size_t{size.nodes} * sizeof(WideNode<kWidth>) +
                       (size_t{size.units} + TriangleLeaf::kPadding) * sizeof(LeafUnit));
  layout.nodes = LineArray<WideNode<kWidth>>(size.nodes);
  layout.leaves = LineArray<LeafUnit>(size_t{size.units} + TriangleLeaf::kPadding);
  layout.bounds = bvh.nodes[0].bounds();
  layout.root = Writer<kWidth>(bvh, geometries, collapse, layout).write(0, 0, 0, 0);
  return layout;
}

template <uint32_t kWidth>
std::optional<std::string> find_fault(const WideBvh<kWidth>& layout, std::span<const Geometry> geometries) {
  return Check<kWidth>(layout, geometries).run();
}

template <uint32_t kWidth>
uint64_t tree_hash(const WideBvh<kWidth>& layout) {
  if (layout.is_empty()) return 0;
  return hash_values(hash_values(layout.root.word, layout.nodes.span()), layout.leaves.span());
}

#define KERF_INSTANTIATE(width)                                                                                        \
  template std::vector<LeafSlot> WideBvh<width>::slots(WideChild) const;                                               \
  template WideBvh<width> make_wide_bvh<width>(const Bvh&, std::span<const Geometry>, const WideCosts&, LeafNumbers*); \
  template std::optional<std::string> find_fault<width>(const WideBvh<width>&, std::span<const Geometry>);             \
  template uint64_t tree_hash<width>(const WideBvh<width>&);
KERF_INSTANTIATE(4)
KERF_INSTANTIATE(8)
#undef KERF_INSTANTIATE

}  // namespace kerf
