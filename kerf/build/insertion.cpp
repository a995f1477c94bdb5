#include <algorithm>
#include <array>
#include <limits>

#include "kerf/base/mix.h"
#include "kerf/build/builders.h"
#include "kerf/build/reference_order.h"

namespace kerf {
namespace {

/// A node of the growing tree.
struct GrowingNode {
  Box3f bounds;
  uint32_t first = 0;  ///< inner node: its children are nodes first and first + 1; leaf: its reference
  uint32_t count = 1;  ///< references below; 1: a leaf

  bool is_leaf() const { return count == 1; }
};

/// A binary tree that takes one reference after another, each where it adds least to the surface area of inner nodes:
/// the growth of those above, inherited, and the new one around the node found and itself. Looked at are the nodes on
/// the way down, always into the child whose box grows least (Goldsmith and Salmon 1987), or after those any that may
/// be better, those with the least inherited growth first (Bittner, Hapala, Havran: Incremental BVH Construction for
/// Ray Tracing, 2015).
class GrowingTree {
 public:
  GrowingTree(std::span<const Reference> references, std::span<const uint32_t> order, bool search_all,
              const WorkLimit& limit)
      : search_all_(search_all) {
    nodes_.reserve(2 * references.size());
    limit.plan(static_cast<double>(order.size()));
    for (size_t i = 0; i < order.size(); ++i) {
      if (i % kCheckEvery == kCheckEvery - 1) limit.advance(kCheckEvery);
      insert(order[i], references[order[i]].bounds());
    }
  }

  std::span<const GrowingNode> nodes() const { return nodes_; }

 private:
  static constexpr size_t kCheckEvery = 1024;
  static constexpr size_t kLongestWay = 256;     // nodes on the way down, at most: the work is bounded
  static constexpr size_t kLongestSearch = 512;  // nodes looked at beside the way, at most

  /// A node looked at.
  struct Visit {
    uint32_t node = 0;
    uint32_t above = 0;    ///< the visit of its parent; the root's is its own
    double inherited = 0;  ///< growth of the nodes above
  };

  void insert(uint32_t reference, const Box3f& box) {
    if (nodes_.empty()) return nodes_.push_back({box, reference, 1});
    visits_.clear();
    visits_.push_back({});
    double least = std::numeric_limits<double>::infinity();
    uint32_t best = walk_down(box, least);
    if (search_all_) best = search(box, best, least);
    for (uint32_t i = best; i != visits_[i].above;) {
      i = visits_[i].above;
      nodes_[visits_[i].node].bounds.extend(box);
      ++nodes_[visits_[i].node].count;
    }
    const uint32_t place = visits_[best].node;
    const GrowingNode old = nodes_[place];
    const auto pair = static_cast<uint32_t>(nodes_.size());
    nodes_.push_back(old);
    nodes_.push_back({box, reference, 1});
    nodes_[place] = {united(old.bounds, box), pair, old.count + 1};
  }

  /// The visit of the best place on the way into the children that grow least; of equally good ones the deepest.
  uint32_t walk_down(const Box3f& box, double& least) {
    uint32_t best = 0;
    for (uint32_t i = 0; i < kLongestWay; ++i) {
      const GrowingNode& node = nodes_[visits_[i].node];
      const double area = half_area(united(node.bounds, box));
      if (visits_[i].inherited + area <= least) {
        least = visits_[i].inherited + area;
        best = i;
      }
      const double inherited = visits_[i].inherited + area - half_area(node.bounds);
      if (node.is_leaf() || inherited > least) break;
      visits_.push_back({least_growth(node.first, box), i, inherited});
    }
    return best;
  }

  /// Of two nodes the one whose box grows less, else the one with fewer references, so that equal boxes make a balanced
  /// tree.
  uint32_t least_growth(uint32_t pair, const Box3f& box) const {
    const auto growth = [&](const GrowingNode& node) {
      return half_area(united(node.bounds, box)) - half_area(node.bounds);
    };
    const GrowingNode &a = nodes_[pair], &b = nodes_[pair + 1];
    const double growth_a = growth(a), growth_b = growth(b);
    if (growth_a != growth_b) return growth_a < growth_b ? pair : pair + 1;
    return a.count <= b.count ? pair : pair + 1;
  }

  /// The visit of a place better than `least`, else `best`. Branch and bound: nothing below a node can be had for less
  /// than what it inherits and the area of the box itself.
  uint32_t search(const Box3f& box, uint32_t best, double least) {
    const double own = half_area(box);
    const auto later = [&](uint32_t a, uint32_t b) {
      return visits_[a].inherited != visits_[b].inherited ? visits_[a].inherited > visits_[b].inherited : a > b;
    };
    visits_.push_back({});
    std::vector<uint32_t> queue{static_cast<uint32_t>(visits_.size() - 1)};
    visits_.back().above = queue[0];
    for (size_t looked_at = 0; !queue.empty() && looked_at < kLongestSearch; ++looked_at) {
      std::pop_heap(queue.begin(), queue.end(), later);
      const uint32_t i = queue.back();
      queue.pop_back();
      const Visit visit = visits_[i];
      if (visit.inherited + own >= least) break;
      const GrowingNode& node = nodes_[visit.node];
      const double area = half_area(united(node.bounds, box));
      if (visit.inherited + area < least) {
        least = visit.inherited + area;
        best = i;
      }
      const double inherited = visit.inherited + area - half_area(node.bounds);
      if (node.is_leaf() || inherited + own >= least) continue;
      for (uint32_t child = node.first; child < node.first + 2; ++child) {
        queue.push_back(static_cast<uint32_t>(visits_.size()));
        visits_.push_back({child, i, inherited});
        std::push_heap(queue.begin(), queue.end(), later);
      }
    }
    return best;
  }

  bool search_all_;
  std::vector<GrowingNode> nodes_;
  std::vector<Visit> visits_;
};

/// Cuts where a tree did: its references, in the order of its leaves, are one stretch for each node. Leaves and the
/// depth bound are then those of all top-down builders.
class GrownOrder : public ReferenceOrder {
 public:
  static constexpr size_t kBytes = sizeof(Reference) + 4 * sizeof(uint32_t);  ///< for each reference

  GrownOrder(std::span<const Reference> references, std::span<const GrowingNode> nodes)
      : ReferenceOrder(in_order(references, nodes)), cuts_(references.size()) {
    if (nodes.empty()) return;
    root_ = middle_of(nodes, nodes[0], 0);
    visit(nodes, [&](const GrowingNode& node, uint32_t begin) {
      if (node.is_leaf()) return;
      const uint32_t middle = middle_of(nodes, node, begin);
      const GrowingNode *left = &nodes[node.first], *right = left + 1;
      cuts_[middle] = {begin, begin + node.count, middle_of(nodes, *left, begin), middle_of(nodes, *right, middle)};
    });
  }

  std::optional<Halves> split(const Subset& subset) {
    const uint32_t middle = find_middle(subset);
    if (middle == kNowhere) return std::nullopt;
    return halves_at(subset, middle);
  }

  /// Below, the tree is followed no more: its cuts are not where the references are.
  Halves halve(const Subset& subset) {
    std::fill(cuts_.begin() + subset.begin + 1, cuts_.begin() + subset.end, Cut{});
    return ReferenceOrder::halve(subset);
  }

 private:
  static constexpr uint32_t kNowhere = 0;  // no cut lies before the first reference

  /// The inner node that is cut at a place: its stretch, and where its children are cut.
  struct Cut {
    uint32_t begin = 0, end = 0, left = kNowhere, right = kNowhere;
  };

  /// Calls f(node, its first place) for all nodes, from left to right.
  template <class F>
  static void visit(std::span<const GrowingNode> nodes, F&& f) {
    if (nodes.empty()) return;
    std::vector<uint32_t> stack{0};
    uint32_t begin = 0;
    while (!stack.empty()) {
      const GrowingNode& node = nodes[stack.back()];
      stack.pop_back();
      f(node, begin);
      if (node.is_leaf()) {
        ++begin;
      } else {
        stack.insert(stack.end(), {node.first + 1, node.first});
      }
    }
  }

  static std::vector<Reference> in_order(std::span<const Reference> references, std::span<const GrowingNode> nodes) {
    std::vector<Reference> ordered;
    ordered.reserve(references.size());
    visit(nodes, [&](const GrowingNode& node, uint32_t) {
      if (node.is_leaf()) ordered.push_back(references[node.first]);
    });
    return ordered;
  }

  static uint32_t middle_of(std::span<const GrowingNode> nodes, const GrowingNode& node, uint32_t begin) {
    return node.is_leaf() ? kNowhere : begin + nodes[node.first].count;
  }

  /// A subset is all, or lies left of the cut where it ends, or right of the cut where it begins; else, or without a
  /// cut, it is no node of the tree.
  uint32_t find_middle(const Subset& subset) const {
    if (subset.count() == cuts_.size()) return root_;
    if (subset.end < cuts_.size() && cuts_[subset.end].end > 0 && cuts_[subset.end].begin == subset.begin) {
      return cuts_[subset.end].left;
    }
    return cuts_[subset.begin].end == subset.end ? cuts_[subset.begin].right : kNowhere;
  }

  static_assert(kBytes == sizeof(Reference) + sizeof(Cut));
  std::vector<Cut> cuts_;  ///< by place
  uint32_t root_ = kNowhere;
};

/// Every number below `count` once: as they are, or shuffled (Fisher and Yates) by the seed.
std::vector<uint32_t> insertion_order(size_t count, bool shuffled, uint64_t seed) {
  std::vector<uint32_t> order(count);
  for (uint32_t i = 0; i < count; ++i) order[i] = i;
  for (size_t i = count; shuffled && i > 1; --i) std::swap(order[i - 1], order[mix(seed, i) % i]);
  return order;
}

}  // namespace

Bvh build_insertion(BuildInput input, const OptionValues& options) {
  const TopDownOptions shared = TopDownOptions::from(options);
  const std::vector<uint32_t> order =
      insertion_order(input.references.size(), options.is_on("order"), static_cast<uint64_t>(options["seed"]));
  input.limit.check(input.references.size() * (2 * sizeof(GrowingNode) + sizeof(Reference)));
  const auto grown = [&] {
    const ProgressPart part(input.limit, 0.9);
    const HeldBytes held(input.references.size() * (2 * sizeof(GrowingNode) + sizeof(uint32_t) + GrownOrder::kBytes));
    const GrowingTree tree(input.references, order, options.is_on("search"), input.limit);
    return GrownOrder(input.references, tree.nodes());
  };
  GrownOrder partition = grown();
  std::vector<Reference>().swap(input.references);
  return build_top_down(partition, shared, input.limit);
}

}  // namespace kerf
