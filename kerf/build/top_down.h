#pragma once

#include <concepts>
#include <memory>
#include <optional>
#include <string>

#include "kerf/base/error.h"
#include "kerf/base/options.h"
#include "kerf/base/parallel.h"
#include "kerf/base/work_limit.h"
#include "kerf/build/tree_part.h"
#include "kerf/references/reference.h"
#include "kerf/tree/bvh.h"

namespace kerf {

/// The references [begin, end) of a partition's own order, with the box around them.
struct Subset {
  uint32_t begin = 0, end = 0;
  Box3f bounds;
  Box3f centers;       ///< of the references' lower + upper, twice their centres; a partition may leave it empty
  uint32_t spare = 0;  ///< free places from `end` on, for pieces of these references, where a builder cuts them
  uint32_t lost = 0;   ///< free places that there would be besides, had memory not been short

  uint32_t count() const { return end - begin; }
  uint32_t room() const { return count() + spare; }
};

/// The two parts of a subset: [begin, middle) and [middle, end), neither empty.
struct Halves {
  Subset left, right;
};

/// Which plane, or none: what tells one top-down builder from another. It owns the references and their order.
template <class P>
concept Partition = requires(P& p, const Subset& subset, uint32_t i) {
  { p.whole() } -> std::same_as<Subset>;
  /// Reorders the subset at the plane it likes best; nothing if no plane divides it.
  { p.split(subset) } -> std::same_as<std::optional<Halves>>;
  /// Reorders the subset into two halves of equal counts; always possible for two and more.
  { p.halve(subset) } -> std::same_as<Halves>;
  { p.reference(i) } -> std::same_as<const Reference&>;
  /// They are not asked for any more.
  p.free_references();
};

/// What all top-down builders share.
struct TopDownOptions {
  uint32_t leaf_size = 4;  ///< slots in a leaf, at most
  uint32_t max_depth = kMaxDepth;
  double inner_cost = 1;  ///< of visiting an inner node, against primitive_cost for a primitive test
  double primitive_cost = 1;
  bool larger_first = true;  ///< the child with more references is the first; else the left one of the partition
  double leaf_cost = 0;      ///< of visiting a leaf, besides its primitives

  double as_leaf(double references) const { return leaf_cost + primitive_cost * references; }

  static constexpr OptionSpec kSpecs[] = {
      {"leaf", "references in a leaf, at most", 4, 1, 255, true},
      {"depth", "depth of the tree, at most", kMaxDepth, 1, kMaxDepth, true},
      {"inner_cost", "cost of visiting a node, for the leaf decision", 1, 0},
      {"primitive_cost", "cost of testing a primitive, for the leaf decision", 1, 0, 1e30, false, true},
      {"leaf_cost", "cost of visiting a leaf, besides its primitives, for the leaf decision", 0, 0, 1e30},
  };
  static TopDownOptions from(const OptionValues& values) {
    return {static_cast<uint32_t>(values["leaf"]),
            static_cast<uint32_t>(values["depth"]),
            values["inner_cost"],
            values["primitive_cost"],
            true,
            values["leaf_cost"]};
  }
};

namespace detail {

/// How many references fit below a node with `levels` levels to go.
inline uint64_t capacity(uint32_t leaf_size, uint32_t levels) {
  return levels >= 32 ? ~uint64_t{0} : uint64_t{leaf_size} << levels;
}

inline void check_depth(size_t references, const TopDownOptions& options) {
  if (references <= capacity(options.leaf_size, options.max_depth)) return;
  uint32_t needed = options.max_depth;
  while (references > capacity(options.leaf_size, needed)) ++needed;
  throw Error(ErrorCode::invalid_option, "depth",
              std::to_string(references) + " references in leaves of " + std::to_string(options.leaf_size) +
                  " need a depth of at least " + std::to_string(needed) + ", and " + std::to_string(options.max_depth) +
                  " is allowed");
}

/// What a tree is built by: two halves of a subset at this depth, or nothing for a leaf. Their places lie within the
/// subset's own, `room()` of them for each.
template <class D>
concept Divider = requires(D& d, const Subset& subset, uint32_t depth) {
  { d.divide(subset, depth) } -> std::same_as<std::optional<Halves>>;
};

inline double work_in(const Subset& subset) { return work_of_dividing(subset.room()); }

/// The recursion. A subset of many references is a task that gives its halves to others; one of few makes all nodes
/// below it, in the order of the finished tree. So the result does not depend on which came first, and what is made is
/// no larger than it has to be.
template <Divider D>
class Recursion {
 public:
  Recursion(D& divider, bool larger_first, const WorkLimit& limit)
      : divider_(divider), larger_first_(larger_first), limit_(limit) {}

  TreePart build(const Subset& subset, uint32_t depth) {
    TreePart part;
    if (subset.count() < kParallelCount) {
      part.below.reserve(2 * size_t{subset.count()});
      part.root = build_below(subset, depth, part.below);
      part.below = std::vector<BvhNode>(part.below);  // as long as it has to be
      part.held.set(part.below.size() * sizeof(BvhNode));
      limit_.advance(work_in(subset));
      return part;
    }
    const std::optional<Halves> halves = divider_.divide(subset, depth);
    part.root = {subset.bounds.lower, subset.begin, subset.bounds.upper, subset.count()};
    if (!halves) {
      limit_.advance(work_in(subset));
      return part;
    }
    part.root.count = 0;
    limit_.advance(work_in(subset) - work_in(halves->left) - work_in(halves->right));
    part.child = std::make_unique<TreePart[]>(2);
    const uint32_t left = place_of_left(*halves);
    parallel_invoke([&] { part.child[left] = build(halves->left, depth + 1); },
                    [&] { part.child[1 - left] = build(halves->right, depth + 1); });
    return part;
  }

 private:
  static constexpr uint32_t kParallelCount = 2048;  // fewer references are not worth a task

  /// A ray that begins in both boxes visits the first child first: best the one with more to hit.
  uint32_t place_of_left(const Halves& halves) const {
    return larger_first_ && halves.right.count() > halves.left.count() ? 1 : 0;
  }

  BvhNode build_below(const Subset& subset, uint32_t depth, std::vector<BvhNode>& nodes) {
    const std::optional<Halves> halves = divider_.divide(subset, depth);
    if (!halves) return {subset.bounds.lower, subset.begin, subset.bounds.upper, subset.count()};
    const size_t child = nodes.size();
    nodes.resize(child + 2);
    const uint32_t left = place_of_left(*halves);
    for (uint32_t i = 0; i < 2; ++i) {
      const BvhNode made = build_below(i == left ? halves->left : halves->right, depth + 1, nodes);
      nodes[child + i] = made;
    }
    return {subset.bounds.lower, static_cast<uint32_t>(child), subset.bounds.upper, 0};
  }

  D& divider_;
  bool larger_first_;
  const WorkLimit& limit_;
};

/// Areas of two halves, added up, and the same times their counts.
struct AreaSums {
  double areas = 0, areas_times_counts = 0;

  static AreaSums of(const Halves& halves) {
    const double left = half_area(halves.left.bounds), right = half_area(halves.right.bounds);
    return {left + right, left * halves.left.count() + right * halves.right.count()};
  }
};

/// The surface area heuristic (Goldsmith and Salmon 1987; MacDonald and Booth 1990): is a leaf at most as dear as two?
inline bool leaf_is_cheaper(const Subset& subset, const AreaSums& halves, const TopDownOptions& options) {
  const double area = half_area(subset.bounds);
  return options.as_leaf(subset.count()) * area <= options.inner_cost * area + options.leaf_cost * halves.areas +
                                                       options.primitive_cost * halves.areas_times_counts;
}

/// Is it, whatever the halves?
inline bool leaf_is_cheapest(const Subset& subset, const TopDownOptions& options) {
  return options.as_leaf(subset.count()) <= options.inner_cost;
}

/// A partition with the leaf decision and the depth bound.
template <Partition P>
class TopDown {
 public:
  TopDown(P& partition, const TopDownOptions& options) : partition_(partition), options_(options) {}

  /// The two halves, or nothing if the subset shall be a leaf.
  std::optional<Halves> divide(const Subset& subset, uint32_t depth) {
    const bool fits_leaf = subset.count() <= options_.leaf_size;
    if (subset.count() == 1 || depth == options_.max_depth || (fits_leaf && leaf_is_cheapest(subset, options_))) {
      return std::nullopt;
    }
    std::optional<Halves> halves = partition_.split(subset);
    if (!halves && fits_leaf) return std::nullopt;
    // Where no plane divides, or a lopsided one would break the depth bound further down: equal counts keep it.
    const uint64_t room = capacity(options_.leaf_size, options_.max_depth - depth - 1);
    if (!halves || halves->left.count() > room || halves->right.count() > room) halves = partition_.halve(subset);
    return fits_leaf && leaf_is_cheaper(subset, AreaSums::of(*halves), options_) ? std::nullopt : halves;
  }

 private:
  P& partition_;
  const TopDownOptions& options_;
};

/// The tree over `whole`, not empty, in parts; each leaf's `first` is the place of its first reference. Throws
/// Error(invalid_option) if the depth allowed cannot hold the references, Error(stopped) at the limit.
template <Divider D>
TreePart build_parts(D& divider, const Subset& whole, const TopDownOptions& options, const WorkLimit& limit) {
  check_depth(whole.count(), options);
  limit.check(size_t{whole.room()} * (sizeof(Reference) + 2 * sizeof(BvhNode)));
  limit.plan(work_in(whole));
  return Recursion<D>(divider, options.larger_first, limit).build(whole, 0);
}

}  // namespace detail

/// Builds a tree from the root down: recursion, leaf decision, depth bound and threads for every partition, whose
/// references are gone then.
/// Throws Error(invalid_option) if the depth allowed cannot hold the references, Error(stopped) at the limit.
template <Partition P>
Bvh build_top_down(P& partition, const TopDownOptions& options, const WorkLimit& limit = {}) {
  const Subset whole = partition.whole();
  if (whole.count() == 0) return {};
  Bvh bvh;
  detail::TopDown<P> divider(partition, options);
  TreePart tree = detail::build_parts(divider, whole, options, limit);
  bvh.slots.resize(whole.count());
  const HeldBytes slots(bvh.slots.size() * sizeof(LeafSlot));
  parallel_for(whole.count(), 65536, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Reference& reference = partition.reference(static_cast<uint32_t>(i));
      bvh.slots[i] = {reference.geometry, reference.primitive};
    }
  });
  partition.free_references();
  bvh.nodes = joined(std::move(tree));
  return bvh;
}

}  // namespace kerf
