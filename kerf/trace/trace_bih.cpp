#include "kerf/trace/trace_bih.h"

#include <cassert>

#include "kerf/base/fp_environment.h"
#include "kerf/trace/leaf.h"
#include "kerf/trace/ray_box.h"

namespace kerf {
namespace {

/// A node that waits for its turn, with where the ray enters and leaves it. Without initial values, because a stack of
/// them is made for every ray.
struct Waiting {
  uint32_t node;
  float entry, exit;
};

}  // namespace

template <bool kAny, class Counts>
Hit BihTracer::trace(const Ray& ray, Counts& counts) const {
  const StandardFloat standard;
  const PreparedRay prepared(ray);
  if (!prepared.valid || bih.is_empty()) return {};
  const Box3f& b = bih.bounds;
  const BoxRay box_ray(prepared, b);
  const float sides[] = {b.lower.x, b.lower.y, b.lower.z, 0, b.upper.x, b.upper.y, b.upper.z};
  Hit best;
  best.t = prepared.t_max;
  Waiting current{0, 0, Box3f::kInfinity};
  counts.count_boxes(1);
  if (!box_ray.enters(sides, prepared.t_min, best.t, current.entry)) return {};
  uint32_t near_side[3];
  for (uint32_t a = 0; a < 3; ++a) {
    const float t = (sides[box_ray.far_side[a]] - box_ray.origin_far[a]) * box_ray.inverse[a];
    current.exit = t < current.exit ? t : current.exit;
    near_side[a] = prepared.direction_d[a] < 0 ? 1 : 0;
  }
  Waiting stack[kMaxDepth];  // one child waits for each pair above the current node
  uint32_t waiting = 0;
  while (true) {
    counts.count_nodes(1);
    const BihNode& node = bih.nodes[current.node];
    if (node.is_single()) {
      counts.count_boxes(1);
      const uint32_t axis = node.axis(), near = near_side[axis];
      const float enter = (node.clip(near) - box_ray.origin_near[axis]) * box_ray.inverse[axis];
      const float leave = (node.clip(1 - near) - box_ray.origin_far[axis]) * box_ray.inverse[axis];
      current.entry = enter > current.entry ? enter : current.entry;
      current.exit = leave < current.exit ? leave : current.exit;
      if (current.entry <= current.exit && current.entry <= best.t) {
        current.node = node.child();
        continue;
      }
    } else if (!node.is_leaf()) {
      counts.count_boxes(2);
      const uint32_t axis = node.axis(), near = near_side[axis];
      const float leave_near = (node.clip(near) - box_ray.origin_far[axis]) * box_ray.inverse[axis];
      const float enter_far = (node.clip(1 - near) - box_ray.origin_near[axis]) * box_ray.inverse[axis];
      // A NaN from 0 * infinity bounds nothing.
      const float near_exit = leave_near < current.exit ? leave_near : current.exit;
      const float far_entry = enter_far > current.entry ? enter_far : current.entry;
      const bool enters_far = far_entry <= current.exit && far_entry <= best.t;
      const Waiting far{node.child() + 1 - near, far_entry, current.exit};
      if (current.entry <= near_exit) {
        assert(waiting < kMaxDepth);
        if (enters_far) stack[waiting++] = far;
        current = {node.child() + near, current.entry, near_exit};
        continue;
      }
      if (enters_far) {
        current = far;
        continue;
      }
    } else {
      for (const LeafSlot& slot : std::span(bih.slots).subspan(node.first(), node.count())) {
        if (test_primitive(geometries, slot, prepared, best, counts) && kAny) return best;
      }
    }
    do {
      if (waiting == 0) return finished(best);
      current = stack[--waiting];
    } while (current.entry > best.t);
  }
}

const TraceTable& bih_table() { return kTraceTable<BihTracer>; }

}  // namespace kerf
