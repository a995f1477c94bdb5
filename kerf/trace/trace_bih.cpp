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

  /// It begins or ends at a plane; a NaN from 0 * infinity bounds nothing.
  void begin_at(float plane, const BoxRay& ray, uint32_t axis) {
    const float t = (plane - ray.origin_near[axis]) * ray.inverse[axis];
    entry = t > entry ? t : entry;
  }
  void end_at(float plane, const BoxRay& ray, uint32_t axis) {
    const float t = (plane - ray.origin_far[axis]) * ray.inverse[axis];
    exit = t < exit ? t : exit;
  }
  bool is_reached(float limit) const { return entry <= exit && entry <= limit; }
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
    near_side[a] = prepared.direction_d[a] < 0 ? 1 : 0;
    current.end_at(sides[box_ray.far_side[a]], box_ray, a);
  }
  Waiting stack[kMaxDepth];  // one child waits for each pair above the current node
  uint32_t waiting = 0;
  while (true) {
    counts.count_nodes(1);
    const BihNode& node = bih.nodes[current.node];
    counts.count_boxes(node.children());
    if (node.is_single()) {
      const uint32_t axis = node.axis(), near = near_side[axis];
      current.node = node.child();
      current.begin_at(node.clip(near), box_ray, axis);
      current.end_at(node.clip(1 - near), box_ray, axis);
      if (current.is_reached(best.t)) continue;
    } else if (!node.is_leaf()) {
      const uint32_t axis = node.axis(), near = near_side[axis];
      Waiting far = current;
      far.node = node.child() + 1 - near;
      far.begin_at(node.clip(1 - near), box_ray, axis);
      current.node = node.child() + near;
      current.end_at(node.clip(near), box_ray, axis);
      const bool reaches_far = far.is_reached(best.t);
      if (current.is_reached(best.t)) {
        assert(waiting < kMaxDepth);
        if (reaches_far) stack[waiting++] = far;
        continue;
      }
      if (reaches_far) {
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
