#include "kerf/layout/bvh2.h"

#include "kerf/base/parallel.h"

namespace kerf {

Bvh2 make_bvh2(Bvh&& bvh) {
  Bvh2 layout;
  if (bvh.nodes.empty()) return layout;
  // A Bvh stores children in pairs from node 1 on, so the pair (1, 2) becomes node 0, (3, 4) node 1 and so on.
  const auto child_of = [&](const BvhNode& node) {
    return Bvh2Child{node.lower, node.is_leaf() ? node.first : (node.first - 1) / 2, node.upper, node.count};
  };
  layout.root = child_of(bvh.nodes[0]);
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
    return BvhNode{child.lower, child.count > 0 ? child.first : 2 * child.first + 1, child.upper, child.count};
  };
  bvh.nodes.push_back(node_of(layout.root));
  for (const Bvh2Node& node : layout.nodes) {
    for (const Bvh2Child& child : node.child) bvh.nodes.push_back(node_of(child));
  }
  bvh.slots = layout.slots;
  return bvh;
}

}  // namespace kerf
