#include "kerf/build/late_split.h"

#include <atomic>
#include <cassert>

#include "kerf/base/parallel.h"
#include "kerf/references/middle_cut.h"

namespace kerf {
namespace {

using Node = LateSplitNode;

/// A leaf of the finished tree.
struct Leaf {
  Reference reference;
  uint32_t depth = 0;
};

/// By number of their slots.
std::vector<Leaf> leaves_of(const Bvh& bvh) {
  std::vector<Leaf> leaves(bvh.slots.size());
  std::vector<std::pair<uint32_t, uint32_t>> stack{{0, 0}};
  while (!stack.empty()) {
    const auto [number, depth] = stack.back();
    stack.pop_back();
    const BvhNode& node = bvh.nodes[number];
    if (node.is_leaf()) {
      assert(node.count == 1);
      const LeafSlot& slot = bvh.slots[node.first];
      leaves[node.first] = {{node.lower, slot.geometry(), node.upper, slot.primitive}, depth};
      continue;
    }
    stack.emplace_back(node.first + 1, depth + 1);
    stack.emplace_back(node.first, depth + 1);
  }
  return leaves;
}

/// The limit that keeps the cap: what early splitting of the leaves needs, for they are cut alike.
double fitting_limit(const std::vector<Leaf>& leaves, const Clipper& clipper, const EarlySplit& options,
                     const WorkLimit& limit) {
  std::vector<Reference> references;
  references.reserve(leaves.size());
  const HeldBytes held(leaves.size() * sizeof(Reference));
  for (const Leaf& leaf : leaves) references.push_back(leaf.reference);
  return early_split(references, clipper, options, limit).limit;
}

/// Cuts leaves into trees whose pairs are numbered from 0.
class PieceTrees {
 public:
  /// `told`: the pairs of all such trees together, which the limit is for.
  PieceTrees(const Clipper& clipper, double sa_max, const WorkLimit& limit, std::atomic<size_t>& told)
      : clipper_(clipper), sa_max_(sa_max), limit_(limit), told_(told) {}

  /// The node that takes the leaf's place.
  Node add(const Leaf& leaf, uint32_t slot) {
    slot_ = slot;
    Node node = cut(leaf.reference, leaf.depth);
    if (node.kind == Node::kPiece) return {leaf.reference.lower, slot, leaf.reference.upper, Node::kWholeLeaf};
    node.kind = Node::kCutLeaf;
    return node;
  }

  std::vector<LateSplitPair> pairs;

 private:
  static constexpr size_t kTellEvery = 256;

  Node cut(Reference piece, uint32_t depth) {
    while (surface_area(piece.bounds()) > sa_max_ && depth < kMaxDepth) {
      const auto parts = cut_in_the_middle(piece, clipper_);
      if (!parts) break;
      if (!parts->below.is_empty() && !parts->above.is_empty()) return divide(piece, *parts, depth);
      piece = with_box(piece, parts->below.is_empty() ? parts->above : parts->below);
    }
    return {piece.lower, slot_, piece.upper, Node::kPiece};
  }

  Node divide(const Reference& piece, const ClippedBoxes& parts, uint32_t depth) {
    const auto pair = static_cast<uint32_t>(pairs.size());
    pairs.emplace_back();
    if (pairs.size() % kTellEvery == 0) limit_.check((told_ += kTellEvery) * sizeof(LateSplitPair));
    const Node below = cut(with_box(piece, parts.below), depth + 1);
    const Node above = cut(with_box(piece, parts.above), depth + 1);
    pairs[pair] = {{below, above}};
    return {piece.lower, pair, piece.upper, Node::kInnerPiece};
  }

  const Clipper& clipper_;
  double sa_max_;
  const WorkLimit& limit_;
  std::atomic<size_t>& told_;
  uint32_t slot_ = 0;
};

/// What one block of leaves becomes.
struct Block {
  std::vector<Node> nodes;
  std::vector<LateSplitPair> pairs;
};

std::vector<Block> cut_leaves(const std::vector<Leaf>& leaves, const Clipper& clipper, double sa_max,
                              const WorkLimit& limit, size_t grain) {
  std::vector<Block> blocks((leaves.size() + grain - 1) / grain);
  std::atomic<size_t> pairs = 0;
  limit.plan(static_cast<double>(leaves.size()));
  parallel_for(leaves.size(), grain, [&](size_t begin, size_t end) {
    PieceTrees trees(clipper, sa_max, limit, pairs);
    Block& block = blocks[begin / grain];
    for (size_t i = begin; i < end; ++i) block.nodes.push_back(trees.add(leaves[i], static_cast<uint32_t>(i)));
    block.pairs = std::move(trees.pairs);
    limit.advance(static_cast<double>(end - begin));
  });
  return blocks;
}

/// The node with its pair counted from `first_pair`.
Node moved(Node node, size_t first_pair) {
  if (!node.is_leaf()) node.first += static_cast<uint32_t>(first_pair);
  return node;
}

}  // namespace

LateSplitBvh build_late_split(const Bvh& bvh, const Clipper& clipper, const EarlySplit& options,
                              const WorkLimit& limit) {
  constexpr size_t kGrain = 1024;
  LateSplitBvh tree;
  const std::vector<Leaf> leaves = bvh.nodes.empty() ? std::vector<Leaf>() : leaves_of(bvh);
  const HeldBytes of_leaves(leaves.size() * sizeof(Leaf));
  limit.check();
  const double sa_max = fitting_limit(leaves, clipper, options, limit);
  if (leaves.empty()) return tree;
  limit.check(bvh.bytes());
  std::vector<Block> blocks = cut_leaves(leaves, clipper, sa_max, limit, kGrain);

  // The pairs of the finished tree come first, in its order, then those of the pieces, by leaf.
  size_t cut = 0;
  for (const Block& block : blocks) cut += block.pairs.size();
  const HeldBytes held(leaves.size() * (sizeof(Node) + sizeof(LeafSlot)) +
                       (bvh.nodes.size() / 2 + 2 * cut) * sizeof(LateSplitPair));
  const size_t upper_pairs = (bvh.nodes.size() - 1) / 2;
  std::vector<size_t> first_pair{upper_pairs};
  for (const Block& block : blocks) first_pair.push_back(first_pair.back() + block.pairs.size());
  limit.check(first_pair.back() * sizeof(LateSplitPair));
  tree.pairs.resize(first_pair.back());
  const auto node_of = [&](const BvhNode& node) {
    if (!node.is_leaf()) return Node{node.lower, (node.first - 1) / 2, node.upper, Node::kInner};
    const size_t block = node.first / kGrain;
    return moved(blocks[block].nodes[node.first % kGrain], first_pair[block]);
  };
  tree.root = node_of(bvh.nodes[0]);
  for (size_t i = 0; i < upper_pairs; ++i) {
    tree.pairs[i] = {{node_of(bvh.nodes[2 * i + 1]), node_of(bvh.nodes[2 * i + 2])}};
  }
  parallel_for(blocks.size(), 1, [&](size_t begin, size_t end) {
    for (size_t b = begin; b < end; ++b) {
      for (size_t i = 0; i < blocks[b].pairs.size(); ++i) {
        const LateSplitPair& pair = blocks[b].pairs[i];
        tree.pairs[first_pair[b] + i] = {{moved(pair.child[0], first_pair[b]), moved(pair.child[1], first_pair[b])}};
      }
    }
  });
  for (const LeafSlot& slot : bvh.slots) tree.slots.push_back({slot.geometry(), slot.primitive});
  return tree;
}

}  // namespace kerf
