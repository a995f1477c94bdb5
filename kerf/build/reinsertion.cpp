#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <numeric>

#include "kerf/base/parallel.h"
#include "kerf/build/collapse.h"
#include "kerf/build/movable_tree.h"
#include "kerf/build/optimisers.h"

namespace kerf {
namespace {

/// A subtree's best new place: beside the target.
struct Move {
  double saving = 0;  ///< what the sum of the inner nodes' half areas falls by
  uint32_t node = 0;
  uint32_t target = 0;
};

/// Less than this share of the area of its parent, which a move removes, is not worth a move.
constexpr double kLeastShare = 1e-6;

/// Finds where a subtree adds least to the areas of inner nodes, by branch and bound: below its sibling, then at each
/// node on the way up and below all that hang off it (Meister and Bittner 2018).
class Search {
 public:
  explicit Search(const MovableTree& tree) : tree_(tree) {}

  /// Of any node but the root; the target is 0 where it is best off.
  Move find(uint32_t n) {
    const MovableTree::Node& node = tree_[n];
    const double parent_area = half_area(tree_[node.parent].bounds());
    best_ = {kLeastShare * parent_area, n, 0};
    box_ = node.bounds();
    area_ = half_area(box_);
    left_ = kLongest;
    // The sibling takes its parent's place, and what is put below it makes it as large as that was.
    Box3f rest = tree_[n ^ 1].bounds();
    if (!tree_[n ^ 1].is_leaf()) wait(n ^ 1, half_area(rest));
    look_below_waiting();
    climb(node.parent, parent_area, rest);
    return best_;
  }

 private:
  static constexpr uint32_t kLongest = 128;  // nodes looked below, at most: the work is bounded

  /// A node to look below, and what a place there saves, less what it costs itself.
  struct Waiting {
    double saved = 0;
    uint32_t node = 0;
  };

  /// Up to the root. `saved` is for places beside the way, `rest` what is left of the way's box.
  void climb(uint32_t way, double saved, Box3f rest) {
    bool shrinks = true;
    while (way != MovableTree::kRoot) {
      look_at(way ^ 1, saved);
      look_below_waiting();
      const uint32_t side = way ^ 1;
      way = tree_[way].parent;
      if (!shrinks) continue;
      rest.extend(tree_[side].bounds());
      const double rest_area = half_area(rest);
      offer(way, saved - rest_area);  // in a new node of the box that this one had
      saved += half_area(tree_[way].bounds()) - rest_area;
      shrinks = !rest.contains(box_);
    }
  }

  void look_at(uint32_t n, double saved) {
    const MovableTree::Node& node = tree_[n];
    const double area = half_area(united(node.bounds(), box_));
    offer(n, saved - area);
    if (!node.is_leaf()) wait(n, saved - (area - half_area(node.bounds())));
  }

  /// Nothing below can save more than what it would with a place of the subtree's own size.
  void wait(uint32_t n, double saved) {
    if (saved - area_ > best_.saving) waiting_[waiting_count_++] = {saved, n};
  }

  void look_below_waiting() {
    while (waiting_count_ > 0) {
      const Waiting next = waiting_[--waiting_count_];
      if (next.saved - area_ <= best_.saving || left_ == 0) continue;
      --left_;
      const uint32_t below = tree_[next.node].below;
      look_at(below, next.saved);
      look_at(below + 1, next.saved);
    }
  }

  void offer(uint32_t target, double saving) {
    if (saving <= best_.saving) return;
    best_.saving = saving;
    best_.target = target;
  }

  const MovableTree& tree_;
  Move best_;
  Box3f box_;
  double area_ = 0;
  uint32_t left_ = 0;
  uint32_t waiting_count_ = 0;
  std::array<Waiting, kMaxDepth + 2> waiting_;  // one on each level, and both on the last
};

/// The nodes of a tree in classes by the area of their boxes, a sixteenth of a power of two wide: what sorts them
/// roughly in one run over them.
class AreaClasses {
 public:
  static constexpr uint32_t kFirst = MovableTree::kRoot + 1;

  explicit AreaClasses(const MovableTree& tree) : tree_(tree), held_(tree.end() * sizeof(uint16_t)), of_(tree.end()) {
    std::vector<Counts> blocks((tree.end() - kFirst + kGrain - 1) / kGrain);
    parallel_for(tree.end() - kFirst, kGrain, [&](size_t begin, size_t end) {
      Counts& counts = blocks[begin / kGrain];
      counts.resize(kClasses);
      for (size_t n = kFirst + begin; n < kFirst + end; ++n) {
        of_[n] = static_cast<uint16_t>(std::bit_cast<uint64_t>(area(static_cast<uint32_t>(n))) >> kDroppedBits);
        ++counts[of_[n]];
      }
    });
    counts_.resize(kClasses);
    for (const Counts& block : blocks)
      std::transform(counts_.begin(), counts_.end(), block.begin(), counts_.begin(), std::plus<>());
  }

  double area(uint32_t n) const { return half_area(tree_[n].bounds()); }

  /// The so many with the largest boxes, in order.
  std::vector<uint32_t> largest(size_t wanted) const {
    size_t above = 0;  // in classes that are taken whole
    uint32_t last = kClasses - 1;
    while (above + counts_[last] < wanted) above += counts_[last--];
    std::vector<uint32_t> nodes, some;
    nodes.reserve(wanted + counts_[last]);
    for (uint32_t n = kFirst; n < tree_.end(); ++n) {
      if (of_[n] >= last) nodes.push_back(n);
      if (of_[n] == last) some.push_back(n);
    }
    const auto end_of_taken = some.begin() + static_cast<ptrdiff_t>(wanted - above);
    std::nth_element(some.begin(), end_of_taken, some.end(),
                     [&](uint32_t a, uint32_t b) { return area(a) != area(b) ? area(a) > area(b) : a < b; });
    std::sort(end_of_taken, some.end());
    const auto is_left = [&](uint32_t n) { return of_[n] == last && std::binary_search(end_of_taken, some.end(), n); };
    nodes.erase(std::remove_if(nodes.begin(), nodes.end(), is_left), nodes.end());
    return nodes;
  }

 private:
  using Counts = std::vector<uint32_t>;
  static constexpr size_t kGrain = 65536;
  static constexpr uint32_t kDroppedBits = 48;  // of an area, which is not negative: its exponent and 4 bits stay
  static constexpr uint32_t kClasses = 1U << 15;

  const MovableTree& tree_;
  HeldBytes held_;
  std::vector<uint16_t> of_;
  Counts counts_;
};

/// The nodes with the largest boxes, `share` of all but the root, in order: where most can be saved. Small trees: all.
std::vector<uint32_t> largest_nodes(const MovableTree& tree, double share) {
  constexpr size_t kFew = 1024;  // hardly cost anything
  const size_t all = tree.end() - AreaClasses::kFirst;
  const auto wanted = std::max(kFew, static_cast<size_t>(std::ceil(share * static_cast<double>(all))));
  if (wanted < all) return AreaClasses(tree).largest(wanted);
  std::vector<uint32_t> nodes(all);
  std::iota(nodes.begin(), nodes.end(), AreaClasses::kFirst);
  return nodes;
}

/// For each of these nodes that has a better place, in the tree as it is, the best: those that save most first.
std::vector<Move> find_moves(const MovableTree& tree, const std::vector<uint32_t>& nodes, const WorkLimit& limit) {
  constexpr size_t kGrain = 256;
  std::vector<std::vector<Move>> blocks((nodes.size() + kGrain - 1) / kGrain);
  limit.plan(static_cast<double>(nodes.size()));
  parallel_for(nodes.size(), kGrain, [&](size_t begin, size_t end) {
    Search search(tree);
    for (size_t i = begin; i < end; ++i) {
      const Move move = search.find(nodes[i]);
      if (move.target != 0) blocks[begin / kGrain].push_back(move);
    }
    limit.advance(static_cast<double>(end - begin));
  });
  std::vector<Move> moves;
  size_t found = 0;
  for (const std::vector<Move>& block : blocks) found += block.size();
  const HeldBytes held(2 * found * sizeof(Move));
  moves.reserve(found);
  for (std::vector<Move>& block : blocks) {
    moves.insert(moves.end(), block.begin(), block.end());
    std::vector<Move>().swap(block);
  }
  LimitWatch watch;
  std::sort(moves.begin(), moves.end(), [&](const Move& a, const Move& b) {
    watch.step();
    return a.saving != b.saving ? a.saving > b.saving : a.node < b.node;
  });
  return moves;
}

/// One after another, each if it still saves something in the tree that those before it made: so no two contradict each
/// other, and the cost never rises. Whether any was made.
bool make_moves(MovableTree& tree, const std::vector<Move>& moves, const WorkLimit& limit) {
  constexpr size_t kCheckEvery = 1024;
  bool any = false;
  for (size_t i = 0; i < moves.size(); ++i) {
    if (i % kCheckEvery == 0) limit.check();
    const auto& [saving, n, target] = moves[i];
    if (tree.saving(n, target) <= kLeastShare * half_area(tree[tree[n].parent].bounds())) continue;
    tree.move(n, target);
    any = true;
  }
  return any;
}

}  // namespace

Bvh optimise_reinsertion(Bvh bvh, const OptionValues& options, const WorkLimit& limit) {
  if (bvh.nodes.empty()) return bvh;
  limit.check(MovableTree::bytes_for(bvh) + bvh.bytes());
  HeldBytes given(bvh.bytes());
  const HeldBytes held(MovableTree::bytes_for(bvh));
  MovableTree tree(bvh);
  std::vector<BvhNode>().swap(bvh.nodes);
  given.set(bvh.bytes());
  const auto iterations = static_cast<uint32_t>(options["iterations"]);
  for (uint32_t i = 0; i < iterations; ++i) {
    const ProgressPart part(limit, 1.0 / (iterations - i));
    if (!make_moves(tree, find_moves(tree, largest_nodes(tree, options["share"]), limit), limit)) break;
  }
  limit.check();
  const LeafRule rule{static_cast<uint32_t>(options["leaf"]), options["inner_cost"], options["primitive_cost"],
                      options["leaf_cost"]};
  return Collapse(tree, rule).bvh(bvh.slots);
}

}  // namespace kerf
