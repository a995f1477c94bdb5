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

}  // namespace

Bih build_bih(std::vector<Reference> references, const TopDownOptions& options, const WorkLimit& limit) {
  if (references.empty()) return {};
  GridPlanes planes(std::move(references));
  Bvh bvh = build_top_down(planes, options, limit);
  Bih bih;
  bih.bounds = bvh.nodes[0].bounds();
  bih.nodes.resize(bvh.nodes.size());
  std::vector<uint32_t> begin(bvh.nodes.size());  // the first slot below each node
  for (size_t i = bvh.nodes.size(); i-- > 0;) {
    const BvhNode& node = bvh.nodes[i];
    if (node.is_leaf()) {
      begin[i] = node.first;
      bih.nodes[i] = BihNode::leaf(node.first, node.count);
      continue;
    }
    begin[i] = begin[node.first];
    const uint32_t axis = planes.axis_at(begin[node.first + 1]);
    bih.nodes[i] = BihNode::inner((node.first - 1) / 2, axis, bvh.nodes[node.first].upper[axis],
                                  bvh.nodes[node.first + 1].lower[axis]);
  }
  bih.slots = std::move(bvh.slots);
  return bih;
}

}  // namespace kerf
