#include "kerf/build/collapse.h"

#include <algorithm>

#include "kerf/base/parallel.h"

namespace kerf {
namespace {

constexpr uint32_t kTaskDepth = 10;  // subtrees from here on are not worth tasks of their own

template <class F, class G>
void both(uint32_t depth, F&& f, G&& g) {
  if (depth < kTaskDepth) return parallel_invoke(f, g);
  f();
  g();
}

}  // namespace

Collapse::Collapse(const MovableTree& tree, const LeafRule& rule)
    : tree_(tree), rule_(rule), held_(tree.end() * sizeof(Summary)), summaries_(tree.end()) {
  choose(MovableTree::kRoot, 0);
}

/// The least cost of the subtree.
double Collapse::choose(uint32_t n, uint32_t depth) {
  const MovableTree::Node& node = tree_[n];
  const double area = half_area(node.bounds());
  if (node.is_leaf()) {
    summaries_[n].slots = tree_.slot_count(node);
    return rule_.as_leaf(summaries_[n].slots) * area;
  }
  double cost[2];
  both(
      depth, [&] { cost[0] = choose(node.below, depth + 1); }, [&] { cost[1] = choose(node.below + 1, depth + 1); });
  const Summary &a = summaries_[node.below], &b = summaries_[node.below + 1];
  const double inner = rule_.inner_cost * area + cost[0] + cost[1];
  const double leaf = rule_.as_leaf(a.slots + b.slots) * area;
  const bool is_leaf = a.slots + b.slots <= rule_.leaf_size && leaf <= inner;
  summaries_[n] = {a.slots + b.slots, is_leaf ? 0 : a.nodes + b.nodes + 2};
  return is_leaf ? leaf : inner;
}

Bvh Collapse::bvh(const std::vector<LeafSlot>& slots) const {
  Bvh bvh;
  const size_t nodes = size_t{summaries_[MovableTree::kRoot].nodes} + 1;
  const HeldBytes held(nodes * sizeof(BvhNode) + slots.size() * sizeof(LeafSlot));
  bvh.nodes.resize(nodes);
  bvh.slots.resize(slots.size());
  write(bvh, slots, {MovableTree::kRoot, 0, 1, 0, 0});
  return bvh;
}

void Collapse::write(Bvh& bvh, const std::vector<LeafSlot>& slots, const Place& place) const {
  const MovableTree::Node& from = tree_[place.from];
  const Summary& summary = summaries_[place.from];
  BvhNode& node = bvh.nodes[place.to];
  node = {from.lower, place.slot, from.upper, summary.slots};
  if (summary.nodes == 0) {
    uint32_t to = place.slot;
    return copy_slots(bvh, slots, place.from, to);
  }
  node.first = place.below;
  node.count = 0;
  // A ray that begins in both boxes visits the first child first: best the one with more to hit.
  const uint32_t second = summaries_[from.below].slots >= summaries_[from.below + 1].slots ? 1 : 0;
  const uint32_t a = from.below + 1 - second, b = from.below + second;
  both(
      place.depth,
      [&] {
        write(bvh, slots, {a, place.below, place.below + 2, place.slot, place.depth + 1});
      },
      [&] {
        write(bvh, slots,
              {b, place.below + 1, place.below + 2 + summaries_[a].nodes, place.slot + summaries_[a].slots,
               place.depth + 1});
      });
}

/// Those of all leaves below, from left to right.
void Collapse::copy_slots(Bvh& bvh, const std::vector<LeafSlot>& slots, uint32_t n, uint32_t& to) const {
  const MovableTree::Node& node = tree_[n];
  if (!node.is_leaf()) {
    copy_slots(bvh, slots, node.below, to);
    return copy_slots(bvh, slots, node.below + 1, to);
  }
  std::copy_n(slots.begin() + node.first_slot(), tree_.slot_count(node), bvh.slots.begin() + to);
  to += tree_.slot_count(node);
}

}  // namespace kerf
