#include "kerf/tree/late_split_bvh.h"

#include <algorithm>
#include <unordered_map>
#include <utility>

#include "kerf/tree/hash_values.h"

namespace kerf {
namespace {

using Node = LateSplitNode;

/// Walks the tree and keeps the first thing that is wrong.
class Checker {
 public:
  Checker(const LateSplitBvh& tree, std::span<const Geometry> geometries)
      : tree_(tree), geometries_(geometries), pair_seen_(tree.pairs.size()), slot_owner_(tree.slots.size(), kNobody) {}

  std::optional<std::string> find() {
    if (tree_.is_empty()) {
      return tree_.pairs.empty() ? std::nullopt : std::optional<std::string>("pairs without slots");
    }
    for (const LeafSlot& slot : tree_.slots) {
      if (slot.is_repeated()) return "a slot has a mark";
      if (slot.geometry() >= geometries_.size() || slot.primitive >= primitive_count(geometries_[slot.geometry()])) {
        return "a slot names no primitive";
      }
    }
    if (tree_.root.kind == Node::kInnerPiece || tree_.root.kind == Node::kPiece) return "the root is a piece";
    check(tree_.root, 0, kNobody, 0);
    if (fault_) return fault_;
    if (std::find(pair_seen_.begin(), pair_seen_.end(), false) != pair_seen_.end()) {
      return "a pair that nothing leads to";
    }
    if (std::find(slot_owner_.begin(), slot_owner_.end(), kNobody) != slot_owner_.end()) return "a slot in no leaf";
    return std::nullopt;
  }

 private:
  static constexpr size_t kNobody = static_cast<size_t>(-1);

  static bool is_piece(const Node& node) { return node.kind == Node::kInnerPiece || node.kind == Node::kPiece; }

  /// `owner`: the cut leaf that the node is below, as the number of its pair. `next`: the least number that the node's
  /// own pair may have.
  void check(const Node& node, uint32_t depth, size_t owner, size_t next) {
    if (fault_) return;
    if (depth > kMaxDepth) return fail("a path is longer than " + std::to_string(kMaxDepth));
    if (node.bounds().is_empty()) return fail("a box is empty");
    if (node.kind > Node::kPiece) return fail("a node is of no kind");
    if (node.is_leaf()) return check_leaf(node, owner);
    if (node.first >= tree_.pairs.size() || node.first < next) return fail("a pair is out of range");
    if (pair_seen_[node.first]) return fail("a pair is reached twice");
    pair_seen_[node.first] = true;
    const size_t below = node.kind == Node::kCutLeaf ? node.first : owner;
    for (const Node& child : tree_.pairs[node.first].child) {
      if (!node.bounds().contains(child.bounds())) fail("a box reaches out of its parent's");
      if (is_piece(child) != (node.kind != Node::kInner)) fail("a piece stands outside a cut leaf, or a leaf inside");
      check(child, depth + 1, below, size_t{node.first} + 1);
    }
  }

  /// A slot belongs to one whole leaf or to the pieces of one cut leaf.
  void check_leaf(const Node& node, size_t owner) {
    if (node.first >= tree_.slots.size()) return fail("a slot is out of range");
    size_t& known = slot_owner_[node.first];
    const bool is_piece = node.kind == Node::kPiece;
    const size_t own = is_piece ? owner : tree_.pairs.size();
    if (known != kNobody && (known != own || !is_piece)) return fail("a slot is in two leaves");
    known = own;
    if (!is_piece) return;
    const auto [at, is_new] = slots_of_.emplace(owner, node.first);
    if (!is_new && at->second != node.first) fail("the pieces of a cut leaf have different slots");
  }

  void fail(std::string what) {
    if (!fault_) fault_ = std::move(what);
  }

  const LateSplitBvh& tree_;
  std::span<const Geometry> geometries_;
  std::vector<bool> pair_seen_;
  std::vector<size_t> slot_owner_;
  std::unordered_map<size_t, uint32_t> slots_of_;  ///< of cut leaves
  std::optional<std::string> fault_;
};

}  // namespace

uint64_t tree_hash(const LateSplitBvh& tree) {
  uint64_t hash = hash_values<LateSplitNode>(0, {&tree.root, 1});
  hash = hash_values<LateSplitPair>(hash, tree.pairs);
  return hash_values<LeafSlot>(hash, tree.slots);
}

std::optional<std::string> find_fault(const LateSplitBvh& tree, std::span<const Geometry> geometries) {
  return Checker(tree, geometries).find();
}

}  // namespace kerf
