#include "kerf/build/join_tree.h"

#include <span>
#include <utility>

#include "kerf/base/parallel.h"

namespace kerf {
namespace {

constexpr uint32_t kParallelCount = 4096;  // fewer references are not worth a task

class BvhOfJoins {
 public:
  BvhOfJoins(JoinTree& tree, const TopDownOptions& options, const WorkLimit& limit)
      : tree_(tree), options_(options), limit_(limit) {}

  Bvh make() {
    settle(tree_.root, 0);
    Bvh bvh;
    const HeldBytes held((size_t{node_count(tree_.root)} + 1) * sizeof(BvhNode) +
                         tree_.references.size() * sizeof(LeafSlot));
    bvh.nodes.resize(size_t{node_count(tree_.root)} + 1);
    bvh.slots.resize(tree_.references.size());
    write(bvh, tree_.root, {0, 1, 0});
    return bvh;
  }

 private:
  /// What the surface area heuristic needs to know of a part; only of one that fits in a leaf.
  struct Part {
    Box3f bounds;
    double cost = 0;
  };
  /// Where a part goes: its node, the first of the nodes below it and its first slot.
  struct Place {
    size_t node, below;
    uint32_t slot;
  };

  uint32_t node_count(uint32_t part) const { return tree_.is_join(part) ? tree_.join(part).nodes : 0; }

  template <class F, class G>
  void both(uint32_t references, F&& f, G&& g) const {
    if (references >= kParallelCount) {
      limit_.check();
      parallel_invoke(f, g);
    } else {
      f();
      g();
    }
  }

  /// Decides which joins below are leaves, and keeps the depth bound.
  Part settle(uint32_t part, uint32_t depth) {
    if (!tree_.is_join(part)) {
      const Box3f box = tree_.references[part].bounds();
      return {box, options_.as_leaf(1) * half_area(box)};
    }
    Join& join = tree_.join(part);
    if (depth == options_.max_depth) return leaf(part);
    const uint64_t room = detail::capacity(options_.leaf_size, options_.max_depth - depth - 1);
    if (tree_.reference_count(join.left) > room || tree_.reference_count(join.right) > room) balance(part);
    Part left, right;
    both(
        join.references, [&] { left = settle(join.left, depth + 1); }, [&] { right = settle(join.right, depth + 1); });
    join.nodes = 2 + node_count(join.left) + node_count(join.right);
    if (join.references > options_.leaf_size) return {};
    const Box3f bounds = united(left.bounds, right.bounds);
    const double area = half_area(bounds);
    const double as_leaf = options_.as_leaf(join.references) * area;
    const double as_inner = options_.inner_cost * area + left.cost + right.cost;
    if (as_leaf <= as_inner) join.nodes = 0;
    return {bounds, std::min(as_leaf, as_inner)};
  }

  Part leaf(uint32_t part) {
    tree_.join(part).nodes = 0;
    Part result;
    for (const uint32_t reference : parts_below(part).references) {
      result.bounds.extend(tree_.references[reference].bounds());
    }
    result.cost = options_.as_leaf(tree_.join(part).references) * half_area(result.bounds);
    return result;
  }

  struct Parts {
    std::vector<uint32_t> references, joins;
  };
  /// The references below a part from left to right, and the joins, it the first.
  Parts parts_below(uint32_t part) const {
    Parts parts;
    std::vector<uint32_t> stack{part};
    while (!stack.empty()) {
      const uint32_t top = stack.back();
      stack.pop_back();
      if (tree_.is_join(top)) {
        parts.joins.push_back(top);
        stack.insert(stack.end(), {tree_.join(top).right, tree_.join(top).left});
      } else {
        parts.references.push_back(top);
      }
    }
    return parts;
  }

  /// Makes a join anew: the same references in the same order, halved down to the last.
  void balance(uint32_t part) {
    limit_.check();
    const Parts parts = parts_below(part);
    const uint32_t* next = parts.joins.data();
    halve(parts.references, next);
  }
  /// The part with these references, of the joins from `next` on.
  uint32_t halve(std::span<const uint32_t> references, const uint32_t*& next) {
    if (references.size() == 1) return references[0];
    const uint32_t part = *next++;
    const size_t middle = references.size() / 2;
    const uint32_t left = halve(references.first(middle), next), right = halve(references.subspan(middle), next);
    tree_.join(part) = {left, right, static_cast<uint32_t>(references.size()), 0};
    return part;
  }

  /// Nodes in depth-first order of pairs, the child with more references first; slots in the order of the leaves.
  Box3f write(Bvh& bvh, uint32_t part, const Place& place) const {
    BvhNode& node = bvh.nodes[place.node];
    if (node_count(part) == 0) {
      uint32_t end = place.slot;
      const Box3f box = write_slots(bvh, part, end);
      node = {box.lower, place.slot, box.upper, end - place.slot};
      return box;
    }
    const Join& join = tree_.join(part);
    const bool swapped = tree_.reference_count(join.right) > tree_.reference_count(join.left);
    const uint32_t first = swapped ? join.right : join.left, second = swapped ? join.left : join.right;
    Box3f a, b;
    both(
        join.references,
        [&] {
          a = write(bvh, first, {place.below, place.below + 2, place.slot});
        },
        [&] {
          b = write(bvh, second,
                    {place.below + 1, place.below + 2 + node_count(first), place.slot + tree_.reference_count(first)});
        });
    const Box3f box = united(a, b);
    node = {box.lower, static_cast<uint32_t>(place.below), box.upper, 0};
    return box;
  }

  /// The slots of a leaf from `slot` on, and the box around them.
  Box3f write_slots(Bvh& bvh, uint32_t part, uint32_t& slot) const {
    if (!tree_.is_join(part)) {
      const Reference& reference = tree_.references[part];
      bvh.slots[slot++] = {reference.geometry, reference.primitive};
      return reference.bounds();
    }
    const Box3f left = write_slots(bvh, tree_.join(part).left, slot);
    return united(left, write_slots(bvh, tree_.join(part).right, slot));
  }

  JoinTree& tree_;
  const TopDownOptions& options_;
  const WorkLimit& limit_;
};

}  // namespace

Bvh make_bvh(JoinTree tree, const TopDownOptions& options, const WorkLimit& limit) {
  if (tree.references.empty()) return {};
  detail::check_depth(tree.references.size(), options);
  return BvhOfJoins(tree, options, limit).make();
}

}  // namespace kerf
