#include "kerf/build/kd_builder.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "kerf/base/error.h"
#include "kerf/base/parallel.h"
#include "kerf/build/kd_cell.h"
#include "kerf/build/kd_samples.h"

namespace kerf {
namespace {

constexpr size_t kParallelCount = 2048;  // cells of fewer references are built by one task
constexpr size_t kSampledCount = 64;     // cells of fewer references are swept: sampling would cost more
constexpr size_t kTrialCount = 16;       // fewer references are tested sooner than a trial pays
constexpr double kTrialShare = 0.75;  // of a leaf's cost that a trial's subtree may have, or references grow for little
constexpr size_t kCheckCount = 256;   // the limit is looked at for cells of so many references

/// What one task has made: a piece of the tree, or a plane with a part on either side.
struct Part {
  KdPlane plane;
  std::unique_ptr<Part> below, above;
  std::vector<KdNode> nodes;  ///< in order; numbers count from the piece's own first node and slot
  std::vector<LeafSlot> slots;
  KdWork work;
  HeldBytes held;
};

class Builder {
 public:
  Builder(const Clipper& clipper, const KdOptions& options, uint32_t max_depth, const WorkLimit& limit)
      : clipper_(options.clips ? &clipper : nullptr), options_(options), max_depth_(max_depth), limit_(limit) {}

  void build(KdCell cell, Part& part) {
    if (cell.references.size() < kParallelCount) {
      const double work = work_in(cell);
      build_piece(std::move(cell), part);
      part.nodes.shrink_to_fit();
      part.slots.shrink_to_fit();
      part.held.set(part.nodes.size() * sizeof(KdNode) + part.slots.size() * sizeof(LeafSlot));
      limit_.advance(work);
      return;
    }
    const double work = work_in(cell);
    cell.held.set(cell.bytes());
    std::optional<Division> division = divided(cell, part, false);
    if (!division) {
      append_leaf(slots_of(cell), part);
      limit_.advance(work);
      return;
    }
    cell = {};
    KdHalves& halves = division->halves;
    limit_.advance(work - work_in(halves.below) - work_in(halves.above));
    part.plane = division->plane;
    part.below = std::make_unique<Part>();
    part.above = std::make_unique<Part>();
    parallel_invoke([&] { build(std::move(halves.below), *part.below); },
                    [&] { build(std::move(halves.above), *part.above); });
  }

 private:
  /// `is_trial`: no plane pays by itself, but what comes below may. Where primitives lie aslant, as in turned
  /// buildings, halves leave empty space that the next planes cut off.
  struct Division {
    KdPlane plane;
    KdHalves halves;
    bool is_trial;
  };

  /// Appends the subtree of a cell to the part; what a ray through the cell costs.
  double build_piece(KdCell cell, Part& part) {
    std::optional<Division> division = divided(cell, part, options_.tries && !cell.is_of_trial);
    if (!division) return append_leaf(slots_of(cell), part);
    std::vector<LeafSlot> slots;
    if (division->is_trial) slots = slots_of(cell);
    const double area = half_area(cell.bounds);
    const double below_share = half_area(division->halves.below.bounds) / area;
    const double above_share = half_area(division->halves.above.bounds) / area;
    cell = {};
    const size_t number = part.nodes.size(), first_slot = part.slots.size();
    part.nodes.emplace_back();
    double cost = options_.costs.traversal;
    cost += below_share * build_piece(std::move(division->halves.below), part);
    const KdPlane& plane = division->plane;
    part.nodes[number] = KdNode::inner(plane.axis, plane.position, static_cast<uint32_t>(part.nodes.size()));
    cost += above_share * build_piece(std::move(division->halves.above), part);
    if (!division->is_trial || cost < kTrialShare * options_.costs.leaf(slots.size())) return cost;
    part.nodes.resize(number);
    part.slots.resize(first_slot);
    return append_leaf(slots, part);
  }

  /// Nothing if the cell shall be a leaf.
  std::optional<Division> divided(KdCell& cell, Part& part, bool may_try) {
    const size_t count = cell.references.size();
    if (count <= options_.leaf_size || cell.depth == max_depth_) return std::nullopt;
    if (count >= kCheckCount) limit_.check();
    Division division{find_plane(cell, part), {}, false};
    if (!(division.plane.cost < options_.costs.leaf(count))) {
      division.is_trial = true;
      division.plane = middle_plane(cell.bounds);
      if (!may_try || count < kTrialCount || std::isinf(division.plane.cost)) return std::nullopt;
    }
    division.halves = divide(cell, division.plane, clipper_);
    KdCell &below = division.halves.below, &above = division.halves.above;
    if (count >= kParallelCount) {
      cell.held.set(cell.bytes());
      below.held.set(below.bytes());
      above.held.set(above.bytes());
    }
    part.work.cuts += division.halves.cuts;
    if (below.references.size() + above.references.size() > cell.allowed) return std::nullopt;
    below.is_of_trial = above.is_of_trial = division.is_trial;
    return division;
  }

  /// Through the centre of a cell, across its longest side.
  static KdPlane middle_plane(const Box3f& cell) {
    const uint32_t axis = largest_axis(cell.extent());
    const float middle = center(cell, axis);
    if (!(cell.lower[axis] < middle && middle < cell.upper[axis])) return {};
    return {0, axis, middle, true};
  }

  KdPlane find_plane(KdCell& cell, Part& part) {
    const size_t count = cell.references.size();
    if (options_.is_sampled && count >= kSampledCount) {
      part.work.events += 6 * count;
      return cheapest_sampled_plane(cell.references, cell.bounds, options_.costs, options_.samples);
    }
    if (!cell.has_events) {
      cell.events = make_events(cell.references);
      cell.has_events = true;
    }
    for (const std::vector<KdEvent>& line : cell.events) part.work.events += line.size();
    return cheapest_plane(cell.events, count, cell.bounds, options_.costs);
  }

  static std::vector<LeafSlot> slots_of(const KdCell& cell) {
    std::vector<LeafSlot> slots;
    slots.reserve(cell.references.size());
    for (const Reference& r : cell.references) slots.push_back({r.geometry, r.primitive});
    return slots;
  }

  double append_leaf(const std::vector<LeafSlot>& slots, Part& part) {
    part.nodes.push_back(KdNode::leaf(static_cast<uint32_t>(part.slots.size()), static_cast<uint32_t>(slots.size())));
    part.slots.insert(part.slots.end(), slots.begin(), slots.end());
    check_number(std::max(part.slots.size(), part.nodes.size()));
    return options_.costs.leaf(slots.size());
  }

  static void check_number(size_t number) {
    if (number > KdNode::kMaxIndex) throw Error(ErrorCode::too_large, "kd-tree", "more than 2^30 nodes or references");
  }

  static double work_in(const KdCell& cell) { return work_of_dividing(static_cast<double>(cell.allowed)); }

  const Clipper* clipper_;
  const KdOptions& options_;
  uint32_t max_depth_;
  const WorkLimit& limit_;
};

size_t count_nodes(const Part& part) {
  return part.below ? 1 + count_nodes(*part.below) + count_nodes(*part.above) : part.nodes.size();
}
size_t count_slots(const Part& part) {
  return part.below ? count_slots(*part.below) + count_slots(*part.above) : part.slots.size();
}

/// Puts the pieces one after the other, their numbers moved; each is freed when it is done.
void append(Part& part, KdTree& tree, KdWork& work) {
  work.events += part.work.events;
  work.cuts += part.work.cuts;
  const auto number = static_cast<uint32_t>(tree.nodes.size());
  if (part.below) {
    tree.nodes.emplace_back();
    append(*part.below, tree, work);
    part.below.reset();
    tree.nodes[number] = KdNode::inner(part.plane.axis, part.plane.position, static_cast<uint32_t>(tree.nodes.size()));
    append(*part.above, tree, work);
    part.above.reset();
    return;
  }
  const auto slot = static_cast<uint32_t>(tree.slots.size());
  for (KdNode node : part.nodes) {
    node.index_bits += (node.is_leaf() ? slot : number) << 2;
    tree.nodes.push_back(node);
  }
  tree.slots.insert(tree.slots.end(), part.slots.begin(), part.slots.end());
  std::vector<KdNode>().swap(part.nodes);
  std::vector<LeafSlot>().swap(part.slots);
  part.held.release();
  check_current_limit();
}

/// The depth that Havran's thesis (2000) recommends.
uint32_t usual_depth(size_t references) {
  const double depth = 8 + 1.3 * std::log2(static_cast<double>(references));
  return std::min(kMaxDepth, static_cast<uint32_t>(std::lround(depth)));
}

}  // namespace

KdTree build_kd_tree(std::vector<Reference> references, const Clipper& clipper, const KdOptions& options,
                     const WorkLimit& limit, KdWork* work) {
  KdTree tree;
  if (references.empty()) return tree;
  const size_t count = references.size();
  if (count > KdNode::kMaxIndex) throw Error(ErrorCode::too_large, "kd-tree", "more than 2^30 references");
  // At the root the references and their events stand beside those of both halves.
  limit.check(2 * count * (sizeof(Reference) + (options.is_sampled ? 0 : 6) * sizeof(KdEvent)));
  KdCell root;
  for (const Reference& reference : references) root.bounds.extend(reference.bounds());
  root.references = std::move(references);
  root.allowed =
      static_cast<uint64_t>(std::min(options.cap * static_cast<double>(count), static_cast<double>(KdNode::kMaxIndex)));
  tree.bounds = root.bounds;
  limit.plan(work_of_dividing(static_cast<double>(root.allowed)));
  const uint32_t max_depth = options.max_depth > 0 ? std::min(options.max_depth, kMaxDepth) : usual_depth(count);
  Part whole;
  Builder(clipper, options, max_depth, limit).build(std::move(root), whole);
  if (std::max(count_nodes(whole), count_slots(whole)) > KdNode::kMaxIndex) {
    throw Error(ErrorCode::too_large, "kd-tree", "more than 2^30 nodes or references");
  }
  const HeldBytes held(count_nodes(whole) * sizeof(KdNode) + count_slots(whole) * sizeof(LeafSlot));
  tree.nodes.reserve(count_nodes(whole));
  tree.slots.reserve(count_slots(whole));
  KdWork done;
  append(whole, tree, done);
  if (work != nullptr) *work = done;
  return tree;
}

}  // namespace kerf
