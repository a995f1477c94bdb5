#include "kerf/layout/wide_refit.h"

#include <array>

#include "kerf/base/parallel.h"

namespace kerf {
namespace {

constexpr uint32_t kTaskDepth = 5;

/// The leaves of a collapse in the order in which they are written.
class Numbering {
 public:
  Numbering(const Bvh& bvh, const WideCollapse& collapse) : bvh_(bvh), collapse_(collapse) {
    result_.first.resize(collapse.size(0).units / 2 + 1);  // a leaf has two units at least
    result_.numbers.reserve(bvh.slots.size());
  }

  LeafNumbers run() {
    visit(0);
    return std::move(result_);
  }

 private:
  void visit(uint32_t node) {
    if (collapse_.is_leaf(node)) return add_leaf(node);
    WideCollapse::Children children;
    const uint32_t count = collapse_.children(node, children);
    for (uint32_t i = 0; i < count; ++i) visit(children[i]);
  }

  void add_leaf(uint32_t node) {
    watch_.step();
    result_.first[unit_ / 2] = static_cast<uint32_t>(result_.numbers.size());
    unit_ += collapse_.size(node).units;
    below_.clear();
    find_below(node);
    WideCollapse::FewSlots few;
    for (const LeafSlot& slot : collapse_.leaf_slots(node, few)) {
      // Of triangles each stands once; of others every reference stands for itself, whichever it is.
      for (uint32_t& number : below_) {
        if (number == kTaken || bvh_.slots[number] != slot) continue;
        result_.numbers.push_back(number);
        number = kTaken;
        if (!collapse_.is_triangles(node)) break;
      }
      result_.numbers.back() |= LeafNumbers::kLast;
    }
  }

  void find_below(uint32_t node) {
    const BvhNode& n = bvh_.nodes[node];
    if (!n.is_leaf()) {
      find_below(n.first);
      return find_below(n.first + 1);
    }
    for (uint32_t i = n.first; i < n.first + n.count; ++i) below_.push_back(i);
  }

  static constexpr uint32_t kTaken = 0xFFFFFFFFU;

  const Bvh& bvh_;
  const WideCollapse& collapse_;
  LeafNumbers result_;
  size_t unit_ = 0;
  std::vector<uint32_t> below_;  // the slots of a leaf
  LimitWatch watch_;
};

template <class Layout>
class Refit {
 public:
  using Child = typename Layout::Child;
  static constexpr uint32_t kChildren = Layout::kChildren;

  Refit(Layout& layout, const LeafNumbers& numbers, const Fragments& fragments, std::span<const Geometry> geometries)
      : layout_(layout), numbers_(numbers), fragments_(fragments), geometries_(geometries) {}

  RefitOutcome run() {
    RefitOutcome all = visit(layout_.root, 0);
    all.sums.nodes += weighed_area(all.bounds, layout_.root);
    return all;
  }

 private:
  /// Its own area is left to the node above, which knows the box that rays meet.
  RefitOutcome visit(Child child, uint32_t depth) {
    return child.is_leaf() ? visit_leaf(child) : visit_node(layout_.nodes[child.number()], depth);
  }

  template <class Node>
  RefitOutcome visit_node(Node& node, uint32_t depth) {
    std::array<RefitOutcome, kChildren> below;
    const auto some = [&](uint32_t begin, uint32_t end) {
      for (uint32_t i = begin; i < end && node.has_child(i); ++i) below[i] = visit(node.child[i], depth + 1);
    };
    if (depth < kTaskDepth) {
      parallel_invoke([&] { some(0, kChildren / 2); }, [&] { some(kChildren / 2, kChildren); });
    } else {
      some(0, kChildren);
    }
    RefitOutcome all;
    std::array<Box3f, kChildren> boxes;
    uint32_t count = 0;
    for (uint32_t i = 0; i < kChildren && node.has_child(i); ++i) {
      all.bounds.extend(below[i].bounds);
      all.sums.nodes += below[i].sums.nodes;
      all.sums.parts += below[i].sums.parts;
      boxes[count++] = below[i].bounds;
    }
    node.set_bounds(std::span(boxes).first(count));
    for (uint32_t i = 0; i < count; ++i) all.sums.nodes += weighed_area(node.bounds(i), node.child[i]);
    return all;
  }

  double weighed_area(const Box3f& box, Child child) const {
    return half_area(box) * static_cast<double>(child.is_leaf() ? layout_.slot_count(child) : 1);
  }

  RefitOutcome visit_leaf(Child leaf) {
    const std::vector<LeafSlot> slots = layout_.slots(leaf);
    RefitOutcome all;
    const auto add = [&](size_t number, const LeafSlot& slot) {
      const Fragments::Part part = fragments_.part(number, slot, geometries_);
      all.bounds.extend(part.bounds);
      all.sums.parts += part.area;
    };
    size_t at = numbers_.numbers.empty() ? 0 : numbers_.first[leaf.number() / 2];
    for (const LeafSlot& slot : slots) {
      if (numbers_.numbers.empty()) {
        add(0, slot);
        continue;
      }
      uint32_t number = 0;
      do {
        number = numbers_.numbers[at++];
        add(number & ~LeafNumbers::kLast, slot);
      } while ((number & LeafNumbers::kLast) == 0);
    }
    if (leaf.kind() != Child::kSlots) layout_.write_leaf(slots, true, geometries_, leaf.number());
    return all;
  }

  Layout& layout_;
  const LeafNumbers& numbers_;
  const Fragments& fragments_;
  std::span<const Geometry> geometries_;
};

}  // namespace

LeafNumbers number_leaves(const Bvh& bvh, const WideCollapse& collapse) { return Numbering(bvh, collapse).run(); }

template <class Layout>
RefitOutcome refit(Layout& layout, const LeafNumbers& numbers, const Fragments& fragments,
                   std::span<const Geometry> geometries) {
  if (layout.is_empty()) return {};
  const RefitOutcome all = Refit<Layout>(layout, numbers, fragments, geometries).run();
  layout.bounds = all.bounds;
  return all;
}

template RefitOutcome refit(WideBvh<4>&, const LeafNumbers&, const Fragments&, std::span<const Geometry>);
template RefitOutcome refit(WideBvh<8>&, const LeafNumbers&, const Fragments&, std::span<const Geometry>);
template RefitOutcome refit(QuantisedBvh&, const LeafNumbers&, const Fragments&, std::span<const Geometry>);

}  // namespace kerf
