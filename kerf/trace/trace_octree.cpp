#include "kerf/trace/trace_octree.h"

#include <bit>
#include <cassert>

#include "kerf/base/fp_environment.h"
#include "kerf/trace/leaf.h"
#include "kerf/trace/mailbox.h"
#include "kerf/trace/ray_box.h"

namespace kerf {
namespace {

/// At most seven siblings wait for each of kMaxDepth - 1 inner cells above the last one, and the eight children of
/// that.
constexpr uint32_t kMostWaiting = 7 * kMaxDepth + 1;

/// A cell that waits for its turn, with where the ray enters and leaves it. Without initial values, because a stack of
/// them is made for every ray.
struct Waiting {
  float lower[3], upper[3];
  float entry, exit;
  uint32_t node;
};

/// Where a ray enters the far halves of a cell and leaves the near ones, at the earliest and at the latest.
struct Crossings {
  float enter_far[3], leave_near[3];
  float middle[3];
  uint32_t reached = 0xFF;  ///< a bit for each octant, in the ray's order, that the ray may be in

  Crossings(const Waiting& cell, const BoxRay& ray, uint32_t axes, float limit) {
    constexpr uint32_t kFarHalves[3] = {0xAA, 0xCC, 0xF0};
    for (uint32_t a = 0; a < 3; ++a) {
      middle[a] = division(cell.lower[a], cell.upper[a], a, axes);
      const float in = (middle[a] - ray.origin_near[a]) * ray.inverse[a];
      const float out = (middle[a] - ray.origin_far[a]) * ray.inverse[a];
      enter_far[a] = in > cell.entry ? in : cell.entry;  // a NaN from 0 * infinity bounds nothing
      leave_near[a] = out < cell.exit ? out : cell.exit;
      if (enter_far[a] > limit || enter_far[a] > cell.exit) reached &= ~kFarHalves[a];
      if (leave_near[a] < cell.entry) reached &= kFarHalves[a];
    }
  }
};

/// The child in an octant, `turned` in the ray's order; its node is not set.
Waiting child_of(const Waiting& cell, const Crossings& crossings, uint32_t octant, uint32_t turned) {
  Waiting child = cell;
  for (uint32_t a = 0; a < 3; ++a) {
    ((octant >> a & 1) != 0 ? child.lower : child.upper)[a] = crossings.middle[a];
    if ((turned >> a & 1) != 0) {
      child.entry = crossings.enter_far[a] > child.entry ? crossings.enter_far[a] : child.entry;
    } else {
      child.exit = crossings.leave_near[a] < child.exit ? crossings.leave_near[a] : child.exit;
    }
  }
  return child;
}

}  // namespace

template <class Seen>
template <bool kAny, class Counts>
Hit OctreeTracer<Seen>::trace(const Ray& ray, Counts& counts) const {
  const StandardFloat standard;
  const PreparedRay prepared(ray);
  if (!prepared.valid || tree.is_empty()) return {};
  const Box3f& b = tree.bounds;
  const BoxRay box_ray(prepared, b);
  const float sides[] = {b.lower.x, b.lower.y, b.lower.z, 0, b.upper.x, b.upper.y, b.upper.z};
  Hit best;
  best.t = prepared.t_max;
  Waiting current{{b.lower.x, b.lower.y, b.lower.z}, {b.upper.x, b.upper.y, b.upper.z}, 0, Box3f::kInfinity, 0};
  counts.count_boxes(1);
  if (!box_ray.enters(sides, prepared.t_min, best.t, current.entry)) return {};
  for (uint32_t a = 0; a < 3; ++a) {
    const float t = (sides[box_ray.far_side[a]] - box_ray.origin_far[a]) * box_ray.inverse[a];
    current.exit = t < current.exit ? t : current.exit;
  }
  uint32_t mirrored = 0;  // axes along which the ray comes to upper halves first
  for (uint32_t a = 0; a < 3; ++a) mirrored |= prepared.direction_d[a] < 0 ? 1U << a : 0;
  Seen seen;
  Waiting stack[kMostWaiting];
  uint32_t waiting = 0;
  while (true) {
    counts.count_nodes(1);
    const OctreeNode node = tree.nodes[current.node];
    if (node.is_leaf()) {
      for (const LeafSlot& slot : std::span(tree.slots).subspan(node.first, node.bits)) {
        if (slot.is_repeated() && seen.has_seen(slot)) continue;
        if (test_primitive(geometries, slot, prepared, best, counts) && kAny) return best;
      }
    } else {
      const Crossings crossings(current, box_ray, tree.axes, best.t);
      // The ray goes from near halves to far ones only, so this order, last first on the stack, is its own.
      for (uint32_t left = crossings.reached; left != 0;) {
        const uint32_t turned = 31 - static_cast<uint32_t>(std::countl_zero(left));
        left &= ~(1U << turned);
        const uint32_t octant = turned ^ mirrored, bit = 1U << octant;
        if ((node.octants() & bit) == 0) continue;
        counts.count_boxes(1);
        assert(waiting < kMostWaiting);
        Waiting& child = stack[waiting];
        child = child_of(current, crossings, octant, turned);
        child.node = node.first + static_cast<uint32_t>(std::popcount(node.octants() & (bit - 1)));
        if (child.entry <= child.exit && child.entry <= best.t) ++waiting;
      }
    }
    do {
      if (waiting == 0) return finished(best);
      current = stack[--waiting];
    } while (current.entry > best.t);
  }
}

const TraceTable& octree_table(bool mailbox) {
  return mailbox ? kTraceTable<OctreeTracer<Mailbox>> : kTraceTable<OctreeTracer<NoMailbox>>;
}

}  // namespace kerf
