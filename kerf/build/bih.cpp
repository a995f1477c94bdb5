#include "kerf/build/bih.h"

#include "kerf/build/reference_order.h"

namespace kerf {
namespace {

class GridPlanes : public ReferenceOrder {
 public:
  explicit GridPlanes(std::vector<Reference> references)
      : ReferenceOrder(std::move(references)), twice_(whole().bounds), axes_(whole().count()) {
    twice_.lower = twice_.lower + twice_.lower;
    twice_.upper = twice_.upper + twice_.upper;
  }

  /// The plane of the smallest cell that holds all centres, found from the scene's box down.
  std::optional<Halves> split(const Subset& subset) {
    if (subset.centers.lower == subset.centers.upper) return std::nullopt;
    Box3f cell = twice_;  // twice, as the centres are
    while (true) {
      const uint32_t axis = largest_axis(cell.extent());
      const float plane = center(cell, axis);
      if (!(cell.lower[axis] < plane && plane < cell.upper[axis])) return std::nullopt;
      if (subset.centers.upper[axis] <= plane) {
        cell.upper[axis] = plane;
      } else if (subset.centers.lower[axis] > plane) {
        cell.lower[axis] = plane;
      } else {
        return remembered(partition(subset, [=](const Reference& r) { return center2(r, axis) <= plane; }), axis);
      }
    }
  }

  Halves halve(const Subset& subset) {
    return remembered(ReferenceOrder::halve(subset), largest_axis(subset.centers.extent()));
  }

  /// The axis of the node whose right half begins at a reference.
  uint32_t axis_at(uint32_t begin) const { return axes_[begin]; }

 private:
  const Halves& remembered(const Halves& halves, uint32_t axis) {
    axes_[halves.right.begin] = static_cast<uint8_t>(axis);
    return halves;
  }

  Box3f twice_;
  std::vector<uint8_t> axes_;  // no two nodes have right halves that begin at the same reference
};

/// Makes the nodes of a Bih from a Bvh of the same partitions.
class Conversion {
 public:
  Conversion(const Bvh& bvh, const GridPlanes& planes, double cut_off)
      : bvh_(bvh), planes_(planes), cut_off_(cut_off), begin_(bvh.nodes.size()), height_(bvh.nodes.size()) {
    for (size_t i = bvh.nodes.size(); i-- > 0;) {
      const BvhNode& node = bvh.nodes[i];
      begin_[i] = node.is_leaf() ? node.first : begin_[node.first];
      if (!node.is_leaf()) height_[i] = 1 + std::max(height_[node.first], height_[node.first + 1]);
    }
  }

  std::vector<BihNode> run() {
    nodes_.resize(1);
    place(0, 0, bvh_.nodes[0].bounds(), 0);
    return std::move(nodes_);
  }

 private:
  /// Puts node `from` and what is below it in place `at`; `box` is what the planes above leave it.
  void place(uint32_t at, uint32_t from, Box3f box, uint32_t depth) {
    const BvhNode& node = bvh_.nodes[from];
    if (node.is_leaf()) {
      nodes_[at] = BihNode::leaf(node.first, node.count);
      return;
    }
    for (; depth + height_[from] < kMaxDepth; ++depth) {
      uint32_t axis = 0;
      Box3f smallest = box;
      for (uint32_t a = 0; a < 3; ++a) {
        Box3f cut = box;
        cut.lower[a] = node.lower[a];
        cut.upper[a] = node.upper[a];
        if (half_area(cut) >= half_area(smallest)) continue;
        smallest = cut;
        axis = a;
      }
      if (smallest == box || half_area(smallest) > cut_off_ * half_area(box)) break;
      nodes_[at] = BihNode::single(add(1), axis, node.lower[axis], node.upper[axis]);
      at = nodes_[at].child();
      box = smallest;
    }
    const BvhNode &left = bvh_.nodes[node.first], &right = bvh_.nodes[node.first + 1];
    const uint32_t axis = planes_.axis_at(begin_[node.first + 1]);
    const uint32_t child = add(2);
    nodes_[at] = BihNode::pair(child, axis, left.upper[axis], right.lower[axis]);
    for (uint32_t side = 0; side < 2; ++side) {
      place(child + side, node.first + side, clipped_by(nodes_[at], box, side), depth + 1);
    }
  }

  uint32_t add(size_t count) {
    const size_t first = nodes_.size();
    if (first + count > BihNode::kMostNodes) {
      throw Error(ErrorCode::too_large, "bih", "a bounding interval hierarchy can hold 536870912 nodes");
    }
    nodes_.resize(first + count);
    return static_cast<uint32_t>(first);
  }

  const Bvh& bvh_;
  const GridPlanes& planes_;
  const double cut_off_;
  std::vector<uint32_t> begin_;   // the first slot below each node
  std::vector<uint32_t> height_;  // edges to the deepest leaf below each node
  std::vector<BihNode> nodes_;
};

}  // namespace

Bih build_bih(std::vector<Reference> references, const TopDownOptions& options, double cut_off,
              const WorkLimit& limit) {
  if (references.empty()) return {};
  GridPlanes planes(std::move(references));
  TopDownOptions left_first = options;
  left_first.larger_first = false;  // the first child is the one below the plane
  Bvh bvh = build_top_down(planes, left_first, limit);
  const HeldBytes held(bvh.bytes() + bvh.nodes.size() * (2 * sizeof(uint32_t) + 3 * sizeof(BihNode)));
  Bih bih;
  bih.bounds = bvh.nodes[0].bounds();
  bih.nodes = Conversion(bvh, planes, cut_off).run();
  bih.nodes.shrink_to_fit();
  bih.slots = std::move(bvh.slots);
  return bih;
}

}  // namespace kerf
