#include "kerf/trace/trace_kd.h"

#include <cassert>

#include "kerf/base/fp_environment.h"
#include "kerf/trace/leaf.h"
#include "kerf/trace/mailbox.h"
#include "kerf/trace/ray_box.h"

namespace kerf {
namespace {

/// A child that waits for its turn, and where the ray may be in it: from early to late.
struct Waiting {
  uint32_t node;
  float from, to;
};

/// Where the ray leaves the box, at the latest.
float exit_of(const BoxRay& ray, const float* box, float limit) {
  for (uint32_t axis = 0; axis < 3; ++axis) {
    const float far = (box[ray.far_side[axis]] - ray.origin_far[axis]) * ray.inverse[axis];
    limit = far < limit ? far : limit;
  }
  return limit;
}

}  // namespace

/// A plane's distance is computed twice, for the ray's origin moved either way as for boxes: `early` lies before any
/// hit above or in the plane, `late` behind any hit below or in it. Where the ray's interval in the cell lies surely on
/// one side of both, the other child is skipped; with a NaN, of a ray within the plane, neither is.
template <bool kMailbox>
template <bool kAny, class Counts>
Hit KdTracer<kMailbox>::trace(const Ray& ray, Counts& counts) const {
  const StandardFloat standard;
  const PreparedRay prepared(ray);
  if (!prepared.valid || tree.is_empty()) return {};
  const BoxRay box_ray(prepared, tree.bounds);
  const float sides[7] = {tree.bounds.lower.x, tree.bounds.lower.y, tree.bounds.lower.z, 0,
                          tree.bounds.upper.x, tree.bounds.upper.y, tree.bounds.upper.z};
  Hit best;
  best.t = prepared.t_max;
  Waiting at{0, 0, 0};
  counts.count_boxes(1);
  if (!box_ray.enters(sides, prepared.t_min, best.t, at.from)) return {};
  at.to = exit_of(box_ray, sides, best.t);
  std::conditional_t<kMailbox, MailboxOf<8>, NoMailbox> mailbox;
  Waiting stack[kMaxDepth];  // one child waits for each level above the current one, and there are at most so many
  uint32_t waiting = 0;
  const KdNode* const nodes = tree.nodes.data();
  const LeafSlot* const slots = tree.slots.data();
  while (true) {
    counts.count_nodes(1);
    const KdNode node = nodes[at.node];
    if (!node.is_leaf()) {
      const uint32_t axis = node.axis();
      const float early = (node.plane() - box_ray.origin_near[axis]) * box_ray.inverse[axis];
      const float late = (node.plane() - box_ray.origin_far[axis]) * box_ray.inverse[axis];
      const bool downwards = box_ray.near_side[axis] >= BoxRay::kUpper;
      const uint32_t below = at.node + 1, above = node.above();
      const uint32_t near = downwards ? above : below, far = downwards ? below : above;
      if (late < at.from) {
        at.node = far;
      } else {
        at.node = near;
        if (!(early > at.to)) {
          assert(waiting < kMaxDepth);
          stack[waiting++] = {far, early > at.from ? early : at.from, at.to};
          at.to = late < at.to ? late : at.to;
        }
      }
      continue;
    }
    for (const LeafSlot *slot = slots + node.first(), *end = slot + node.count(); slot != end; ++slot) {
      if (slot->is_repeated() && mailbox.has_seen(*slot)) continue;
      if (test_primitive(geometries, *slot, prepared, best, counts) && kAny) return best;
    }
    do {
      if (waiting == 0) return finished(best);
      at = stack[--waiting];
    } while (at.from > best.t);
    at.to = best.t < at.to ? best.t : at.to;
  }
}

template <bool kMailbox>
const TraceTable& kd_table() {
  return kTraceTable<KdTracer<kMailbox>>;
}

template const TraceTable& kd_table<false>();
template const TraceTable& kd_table<true>();

}  // namespace kerf
