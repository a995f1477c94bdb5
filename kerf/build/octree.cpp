#include "kerf/build/octree.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <utility>

#include "kerf/base/parallel.h"
#include "kerf/base/rounding.h"

namespace kerf {
namespace {

constexpr size_t kParallelCount = 2048;  // fewer references are not worth tasks

/// A cell while the tree is built.
struct Branch {
  uint32_t octants = 0;
  std::vector<Branch> children;
  std::vector<LeafSlot> slots;
};

class OctreeBuilder {
 public:
  OctreeBuilder(const Clipper& clipper, const OctreeOptions& options, uint32_t axes, const WorkLimit& limit)
      : clipper_(clipper), options_(options), axes_(axes), limit_(limit) {}

  Branch build(std::span<const Reference> references, const Box3f& cell, double room) {
    count(references.size_bytes());
    limit_.plan(work_of_dividing(room));
    Branch root;
    build(root, {references.begin(), references.end()}, cell, 0, room);
    limit_.check(2 * bytes_);  // the tree stands beside the branches that it is made from
    return root;
  }

 private:
  /// `room`: slots that may stand below.
  void build(Branch& branch, std::vector<Reference> pieces, const Box3f& cell, uint32_t depth, double room) {
    std::array<std::vector<Reference>, 8> parts;
    if (pieces.size() <= options_.leaf_size || depth == options_.max_depth || !divide(pieces, cell, room, parts)) {
      branch.slots.reserve(pieces.size());
      for (const Reference& piece : pieces) branch.slots.push_back({piece.geometry, piece.primitive});
      uncount(pieces.capacity() * sizeof(Reference));
      count(pieces.size() * sizeof(LeafSlot));
      if (pieces.size() >= kParallelCount) limit_.advance(work_of_dividing(room));
      return;
    }
    const bool worth_tasks = pieces.size() >= kParallelCount;
    uncount(pieces.capacity() * sizeof(Reference));
    std::vector<Reference>().swap(pieces);
    std::array<uint32_t, 8> octants{};
    size_t count = 0, total = 0;
    for (uint32_t octant = 0; octant < 8; ++octant) {
      total += parts[octant].size();
      if (parts[octant].empty()) continue;
      octants[count++] = octant;
      branch.octants |= 1U << octant;
    }
    branch.children.resize(count);
    if (worth_tasks) {
      double work = work_of_dividing(room);
      for (uint32_t i = 0; i < count; ++i) {
        work -= work_of_dividing(room * static_cast<double>(parts[octants[i]].size()) / static_cast<double>(total));
      }
      limit_.advance(work);
    }
    parallel_for(count, worth_tasks ? 1 : count, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        std::vector<Reference>& part = parts[octants[i]];
        const double share = static_cast<double>(part.size()) / static_cast<double>(total);
        const bool is_told = worth_tasks && part.size() < kParallelCount;
        build(branch.children[i], std::move(part), octant_of(cell, octants[i], axes_), depth + 1, room * share);
        if (is_told) limit_.advance(work_of_dividing(room * share));
      }
    });
  }

  /// Sorts pieces into octants; false if the cell shall not be divided.
  bool divide(const std::vector<Reference>& pieces, const Box3f& cell, double room,
              std::array<std::vector<Reference>, 8>& parts) {
    size_t total = 0;
    LimitWatch watch;
    for (const Reference& piece : pieces) {
      watch.step();
      Reference part = piece;
      const auto cut = [&](const Box3f& box, uint32_t axis, float position) -> CutBoxes {
        part.lower = box.lower;
        part.upper = box.upper;
        const ClippedBoxes boxes = clipper_(part, axis, position);
        return {boxes.below, boxes.above};
      };
      for_each_octant(cell, axes_, piece.bounds(), cut, [&](uint32_t octant, const Box3f& box) {
        part.lower = box.lower;
        part.upper = box.upper;
        parts[octant].push_back(part);
        ++total;
      });
      if (static_cast<double>(total) > room) return false;
    }
    const double area = half_area(cell);
    double below = 0;
    for (uint32_t octant = 0; octant < 8; ++octant) {
      below += half_area(octant_of(cell, octant, axes_)) * static_cast<double>(parts[octant].size());
    }
    if (!(area + below < area * static_cast<double>(pieces.size()))) return false;
    size_t bytes = 0;
    for (const std::vector<Reference>& part : parts) {
      if (!part.empty()) bytes += part.capacity() * sizeof(Reference) + sizeof(Branch);
    }
    count(bytes);
    return true;
  }

  void count(size_t bytes) {
    held_.add(bytes);
    limit_.check(bytes_ += bytes);
  }
  void uncount(size_t bytes) {
    held_.subtract(bytes);
    bytes_ -= bytes;
  }

  const Clipper& clipper_;
  const OctreeOptions& options_;
  const uint32_t axes_;
  const WorkLimit& limit_;
  std::atomic<size_t> bytes_ = 0;  // of the pieces and branches that there are now
  HeldBytes held_;                 // the same, for the work as a whole
};

size_t slot_count(const Branch& branch) {
  size_t count = branch.slots.size();
  for (const Branch& child : branch.children) count += slot_count(child);
  return count;
}

/// Puts a branch and what is below it in its place in the tree.
void flatten(Octree& tree, size_t number, const Branch& branch) {
  if (branch.children.empty()) {
    tree.nodes[number] = {static_cast<uint32_t>(tree.slots.size()), static_cast<uint32_t>(branch.slots.size())};
    tree.slots.insert(tree.slots.end(), branch.slots.begin(), branch.slots.end());
    return;
  }
  const size_t first = tree.nodes.size();
  tree.nodes[number] = {static_cast<uint32_t>(first), OctreeNode::kInner | branch.octants};
  tree.nodes.resize(first + branch.children.size());
  for (size_t i = 0; i < branch.children.size(); ++i) flatten(tree, first + i, branch.children[i]);
}

Box3f bounds_of(std::span<const Reference> references) {
  Box3f bounds;
  for (const Reference& reference : references) bounds.extend(reference.bounds());
  return bounds;
}

}  // namespace

uint32_t shortest_axis(std::span<const Reference> references) {
  const Vec3f extent = bounds_of(references).extent();
  const uint32_t xy = extent.x < extent.y ? kX : kY;
  return extent[xy] < extent.z ? xy : kZ;
}

Octree build_octree(std::span<const Reference> references, const Clipper& clipper, const OctreeOptions& options,
                    const WorkLimit& limit) {
  Octree tree;
  if (references.empty()) return tree;
  tree.axes = options.undivided < 0 ? Octree::kAllAxes : Octree::kAllAxes & ~(1U << options.undivided);
  tree.bounds = bounds_of(references);
  if (options.cube) {
    const double side = largest(to_double(tree.bounds.upper) - to_double(tree.bounds.lower));
    for (uint32_t a = 0; a < 3; ++a) {
      if ((tree.axes >> a & 1) != 0) tree.bounds.upper[a] = round_up(tree.bounds.lower[a] + side);
    }
  }
  const double most =
      std::min(static_cast<double>(kMaxReferences), options.cap * static_cast<double>(references.size()));
  OctreeBuilder builder(clipper, options, tree.axes, limit);  // it accounts for the branches
  const Branch root = builder.build(references, tree.bounds, most);
  tree.nodes.resize(1);
  tree.slots.reserve(slot_count(root));
  const HeldBytes held(tree.slots.capacity() * sizeof(LeafSlot));
  flatten(tree, 0, root);
  tree.nodes.shrink_to_fit();
  tree.slots.shrink_to_fit();
  return tree;
}

}  // namespace kerf
