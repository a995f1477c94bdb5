#include "kerf/layout/skip_pointer.h"

#include <utility>

#include "kerf/base/work_limit.h"

namespace kerf {

SkipPointerBvh make_skip_pointer_bvh(Bvh&& bvh) {
  SkipPointerBvh layout;
  if (bvh.nodes.empty()) return layout;
  const HeldBytes held(bvh.nodes.size() * sizeof(SkipPointerNode));
  layout.nodes.reserve(bvh.nodes.size());
  LimitWatch watch;
  constexpr uint32_t kAfter = 0x80000000U;  // not a node of the Bvh, but an inner one of the layout that ends here
  std::vector<uint32_t> stack{0};
  while (!stack.empty()) {
    watch.step();
    const uint32_t number = stack.back();
    stack.pop_back();
    const auto place = static_cast<uint32_t>(layout.nodes.size());
    if ((number & kAfter) != 0) {
      layout.nodes[number & ~kAfter].first = place;
      continue;
    }
    const BvhNode& node = bvh.nodes[number];
    layout.nodes.push_back({node.lower, node.first, node.upper, node.count});
    if (!node.is_leaf()) stack.insert(stack.end(), {place | kAfter, node.first + 1, node.first});
  }
  layout.slots = std::move(bvh.slots);
  bvh = {};
  return layout;
}

RefitOutcome refit(SkipPointerBvh& layout, const LeafParts& leaf_parts) {
  if (layout.nodes.empty()) return {};
  const auto children = [&](const SkipPointerNode& parent) {
    const auto first = static_cast<uint32_t>(&parent - layout.nodes.data()) + 1;
    return std::pair(&layout.nodes[first], &layout.nodes[layout.after(first)]);
  };
  const RefitSums sums = refit_nodes(layout.nodes[0], children, leaf_parts);
  return {layout.nodes[0].bounds(), sums};
}

std::optional<Bvh> make_bvh(const SkipPointerBvh& layout) {
  Bvh bvh;
  bvh.slots = layout.slots;
  if (layout.nodes.empty()) return bvh;
  struct Copy {
    uint32_t from, end, to;  ///< a node, the one after its subtree, and where it goes
  };
  const auto size = static_cast<uint32_t>(layout.nodes.size());
  std::vector<Copy> stack{{0, size, 0}};
  bvh.nodes.resize(1);
  while (!stack.empty()) {
    const auto [from, end, to] = stack.back();
    stack.pop_back();
    const SkipPointerNode& node = layout.nodes[from];
    if (layout.after(from) != end) return std::nullopt;
    const auto child = static_cast<uint32_t>(bvh.nodes.size());
    bvh.nodes[to] = {node.lower, node.is_leaf() ? node.first : child, node.upper, node.count};
    if (node.is_leaf()) continue;
    if (from + 1 >= end) return std::nullopt;
    const uint32_t second = layout.after(from + 1);
    if (second <= from + 1 || second >= end) return std::nullopt;
    bvh.nodes.resize(bvh.nodes.size() + 2);
    stack.push_back({second, end, child + 1});
    stack.push_back({from + 1, second, child});
  }
  return bvh;
}

std::optional<std::string> find_fault(const SkipPointerBvh& layout, std::span<const Geometry> geometries,
                                      uint32_t largest_leaf) {
  const std::optional<Bvh> bvh = make_bvh(layout);
  if (!bvh) return "a pointer leads into or out of another subtree";
  return find_fault(*bvh, geometries, largest_leaf);
}

}  // namespace kerf
