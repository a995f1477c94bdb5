#pragma once

#include <array>

#include "kerf/base/parallel.h"
#include "kerf/base/work_limit.h"
#include "kerf/layout/wide_collapse.h"
#include "kerf/layout/wide_refit.h"

namespace kerf {

/// Writes the nodes and leaves of a collapse to where its sizes say, subtrees beside each other at once. A Layout has
/// nodes whose set_bounds() takes the boxes of all children, and write_leaf().
template <class Layout>
class WideWriter {
 public:
  using Child = typename Layout::Child;

  WideWriter(const Bvh& bvh, std::span<const Geometry> geometries, const WideCollapse& collapse, Layout& layout)
      : bvh_(bvh), geometries_(geometries), collapse_(collapse), layout_(layout) {}

  /// The wide subtree of a binary node, its nodes and its leaves' units from these numbers on.
  Child write(uint32_t node, size_t first_node, size_t first_unit) {
    if (collapse_.is_leaf(node)) {
      WideCollapse::FewSlots few;
      return layout_.write_leaf(collapse_.leaf_slots(node, few), collapse_.is_triangles(node), geometries_, first_unit);
    }
    WideCollapse::Children children;
    const uint32_t count = collapse_.children(node, children);
    auto& to = layout_.nodes[first_node];
    std::array<Box3f, Layout::kChildren> boxes;
    std::array<size_t, Layout::kChildren> nodes, units;
    size_t next_node = first_node + 1, next_unit = first_unit;
    for (uint32_t i = 0; i < count; ++i) {
      boxes[i] = bvh_.nodes[children[i]].bounds();
      nodes[i] = next_node;
      units[i] = next_unit;
      next_node += collapse_.size(children[i]).nodes;
      next_unit += collapse_.size(children[i]).units;
    }
    to.set_bounds(std::span(boxes).first(count));
    const auto some = [&](uint32_t begin, uint32_t end) {
      for (uint32_t i = begin; i < end; ++i) to.child[i] = write(children[i], nodes[i], units[i]);
    };
    if (next_node - first_node >= kTaskNodes) {
      parallel_invoke([&] { some(0, count / 2); }, [&] { some(count / 2, count); });
    } else {
      some(0, count);
    }
    return Child::of(Child::kInner, first_node);
  }

 private:
  static constexpr size_t kTaskNodes = 64;  // fewer are not worth a task

  const Bvh& bvh_;
  std::span<const Geometry> geometries_;
  const WideCollapse& collapse_;
  Layout& layout_;
};

/// The whole layout of a collapse; `numbers`, where given, gets number_leaves().
template <class Layout>
void write_wide(Layout& layout, const Bvh& bvh, std::span<const Geometry> geometries, const WideCollapse& collapse,
                LeafNumbers* numbers) {
  const WideCollapse::Size size = collapse.size(0);
  const size_t units = size_t{size.units} + TriangleLeaf::kPadding;
  HeldBytes held_numbers;
  if (numbers != nullptr) {
    held_numbers.set((size.units / 2 + bvh.slots.size()) * sizeof(uint32_t));
    *numbers = number_leaves(bvh, collapse);
  }
  const HeldBytes held(size.nodes * sizeof(layout.nodes[0]) + units * sizeof(LeafUnit));
  layout.nodes = decltype(layout.nodes)(size.nodes);
  layout.leaves = LineArray<LeafUnit>(units);
  layout.bounds = bvh.nodes[0].bounds();
  layout.root = WideWriter(bvh, geometries, collapse, layout).write(0, 0, 0);
}

}  // namespace kerf
