#include "kerf/build/kd_builder.h"

#include <algorithm>
#include <atomic>
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
constexpr size_t kCheckCount = 256;      // the limit is looked at for cells of so many references

/// What one task has made: a piece of the tree, or a plane with a part on either side.
struct Part {
  KdPlane plane;
  std::unique_ptr<Part> below, above;
  std::vector<KdNode> nodes;  ///< in order; numbers count from the piece's own first node and slot
  std::vector<LeafSlot> slots;
  KdWork work;
};

class Builder {
 public:
  Builder(const Clipper& clipper, const KdOptions& options, uint32_t max_depth, const WorkLimit& limit)
      : clipper_(options.clips ? &clipper : nullptr), options_(options), max_depth_(max_depth), limit_(limit) {}

  void build(KdCell cell, Part& part) {
    if (cell.references.size() < kParallelCount) {
      build_piece(std::move(cell), part);
      count(part.nodes.size() * sizeof(KdNode) + part.slots.size() * sizeof(LeafSlot));
      return;
    }
    std::optional<KdHalves> halves = divided(cell, part);
    if (!halves) {
      append_leaf(cell, part);
      return;
    }
    cell = {};
    part.below = std::make_unique<Part>();
    part.above = std::make_unique<Part>();
    parallel_invoke([&] { build(std::move(halves->below), *part.below); },
                    [&] { build(std::move(halves->above), *part.above); });
  }

 private:
  /// The subtree of a cell, nodes and slots appended to the part.
  void build_piece(KdCell cell, Part& part) {
    std::optional<KdHalves> halves = divided(cell, part);
    if (!halves) {
      append_leaf(cell, part);
      return;
    }
    cell = {};
    const KdPlane plane = part.plane;
    const size_t number = part.nodes.size();
    part.nodes.emplace_back();
    build_piece(std::move(halves->below), part);
    check_number(part.nodes.size());
    part.nodes[number] = KdNode::inner(plane.axis, plane.position, static_cast<uint32_t>(part.nodes.size()));
    build_piece(std::move(halves->above), part);
  }

  /// Nothing if the cell shall be a leaf. Leaves the plane in the part.
  std::optional<KdHalves> divided(KdCell& cell, Part& part) {
    const size_t count = cell.references.size();
    if (count <= options_.leaf_size || cell.depth == max_depth_) return std::nullopt;
    if (count >= kCheckCount) limit_.check();
    part.plane = find_plane(cell, part);
    if (!(part.plane.cost < options_.costs.leaf(count))) return std::nullopt;
    std::optional<KdHalves> halves = divide(cell, part.plane, clipper_);
    part.work.cuts += halves->cuts;
    if (halves->below.references.size() + halves->above.references.size() > cell.allowed) return std::nullopt;
    return halves;
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

  static void append_leaf(const KdCell& cell, Part& part) {
    part.nodes.push_back(
        KdNode::leaf(static_cast<uint32_t>(part.slots.size()), static_cast<uint32_t>(cell.references.size())));
    for (const Reference& r : cell.references) part.slots.push_back({r.geometry, r.primitive});
    check_number(part.slots.size());
  }

  static void check_number(size_t number) {
    if (number > KdNode::kMaxIndex) throw Error(ErrorCode::too_large, "kd-tree", "more than 2^30 nodes or references");
  }

  void count(size_t bytes) { limit_.check(made_ += bytes); }

  const Clipper* clipper_;
  const KdOptions& options_;
  uint32_t max_depth_;
  const WorkLimit& limit_;
  std::atomic<size_t> made_ = 0;  // bytes of the pieces that are done
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
  const uint32_t max_depth = options.max_depth > 0 ? std::min(options.max_depth, kMaxDepth) : usual_depth(count);
  Part whole;
  Builder(clipper, options, max_depth, limit).build(std::move(root), whole);
  if (std::max(count_nodes(whole), count_slots(whole)) > KdNode::kMaxIndex) {
    throw Error(ErrorCode::too_large, "kd-tree", "more than 2^30 nodes or references");
  }
  tree.nodes.reserve(count_nodes(whole));
  tree.slots.reserve(count_slots(whole));
  KdWork done;
  append(whole, tree, done);
  if (work != nullptr) *work = done;
  return tree;
}

}  // namespace kerf
