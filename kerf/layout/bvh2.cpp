#include "kerf/layout/bvh2.h"

#include <utility>

#include "kerf/base/parallel.h"
#include "kerf/base/work_limit.h"

namespace kerf {
namespace {

uint32_t axis_mark(const Bvh2Node& node) {
  const Box3f first = node.child[0].bounds(), second = node.child[1].bounds();
  Vec3f apart;
  for (uint32_t axis = 0; axis < 3; ++axis) apart[axis] = center(second, axis) - center(first, axis);
  const uint32_t axis = largest_axis(abs(apart));
  return Bvh2Child::kAxisMark | axis | (apart[axis] < 0 ? Bvh2Child::kSecondIsLower : 0);
}

/// Calls f(child) for the root and every child.
template <class Layout, class F>
void for_each_child(Layout& layout, F&& f) {
  if (layout.is_empty()) return;
  f(layout.root);
  for (auto& node : layout.nodes) {
    for (auto& child : node.child) f(child);
  }
}

}  // namespace

Bvh2 make_bvh2(Bvh&& bvh) {
  Bvh2 layout;
  if (bvh.nodes.empty()) return layout;
  // A Bvh stores children in pairs from node 1 on, so the pair (1, 2) becomes node 0, (3, 4) node 1 and so on.
  const auto child_of = [&](const BvhNode& node) {
    return Bvh2Child{node.lower, node.is_leaf() ? node.first : (node.first - 1) / 2, node.upper, node.count};
  };
  layout.root = child_of(bvh.nodes[0]);
  const HeldBytes held(bvh.nodes.size() / 2 * sizeof(Bvh2Node));
  layout.nodes.resize((bvh.nodes.size() - 1) / 2);
  parallel_for(layout.nodes.size(), 16384, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      layout.nodes[i] = {{child_of(bvh.nodes[2 * i + 1]), child_of(bvh.nodes[2 * i + 2])}};
    }
  });
  layout.slots = std::move(bvh.slots);
  bvh = {};
  return layout;
}

Bvh make_bvh(const Bvh2& layout) {
  Bvh bvh;
  if (layout.is_empty()) return bvh;
  const auto node_of = [](const Bvh2Child& child) {
    return BvhNode{child.lower, child.is_leaf() ? child.first : 2 * child.first + 1, child.upper,
                   child.is_leaf() ? child.count : 0};
  };
  bvh.nodes.push_back(node_of(layout.root));
  for (const Bvh2Node& node : layout.nodes) {
    for (const Bvh2Child& child : node.child) bvh.nodes.push_back(node_of(child));
  }
  bvh.slots = layout.slots;
  return bvh;
}

RefitOutcome refit(Bvh2& layout, const LeafParts& leaf_parts) {
  if (layout.is_empty()) return {};
  const auto children = [&](const Bvh2Child& parent) {
    Bvh2Node& node = layout.nodes[parent.first];
    return std::pair(&node.child[0], &node.child[1]);
  };
  const RefitSums sums = refit_nodes(layout.root, children, leaf_parts);
  return {layout.root.bounds(), sums};
}

void mark_axes(Bvh2& layout) {
  for_each_child(layout, [&](Bvh2Child& child) {
    if (!child.is_leaf()) child.count = axis_mark(layout.nodes[child.first]);
  });
}

std::optional<std::string> find_axis_fault(const Bvh2& layout) {
  std::optional<std::string> fault;
  for_each_child(layout, [&](const Bvh2Child& child) {
    if (child.is_leaf() || fault) return;
    if (child.count != axis_mark(layout.nodes[child.first])) {
      fault = "the children of node " + std::to_string(child.first) + " are marked with a wrong axis";
    }
  });
  return fault;
}

}  // namespace kerf
