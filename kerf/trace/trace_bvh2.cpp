#include "kerf/trace/trace_bvh2.h"

#include <cassert>
#include <utility>

#include "kerf/base/fp_environment.h"
#include "kerf/trace/leaf.h"
#include "kerf/trace/ray_box.h"

namespace kerf {
namespace {

/// A child that waits for its turn.
struct Waiting {
  uint32_t first, count;
  float entry;
};

}  // namespace

template <bool kAny, class Counts>
Hit Bvh2Tracer::trace(const Ray& ray, Counts& counts) const {
  const StandardFloat standard;
  const PreparedRay prepared(ray);
  if (!prepared.valid || layout.is_empty()) return {};
  const BoxRay box_ray(prepared, layout.root.bounds());
  Hit best;
  best.t = prepared.t_max;
  Waiting current{layout.root.first, layout.root.count, 0};
  counts.count_boxes(1);
  if (!box_ray.enters(layout.root.sides(), prepared.t_min, best.t, current.entry)) return {};
  Waiting stack[kMaxDepth];  // one child waits for each level above the current one, and there are at most so many
  uint32_t waiting = 0;
  while (true) {
    counts.count_nodes(1);
    if (current.count == 0) {
      const Bvh2Node& node = layout.nodes[current.first];
      Waiting child[2];
      bool entered[2];
      counts.count_boxes(2);
      for (int i = 0; i < 2; ++i) {
        const Bvh2Child& c = node.child[i];
        child[i] = {c.first, c.count, 0};
        entered[i] = box_ray.enters(c.sides(), prepared.t_min, best.t, child[i].entry);
      }
      if (entered[0] && entered[1]) {
        const int near = child[1].entry < child[0].entry ? 1 : 0;
        assert(waiting < kMaxDepth);
        stack[waiting++] = child[1 - near];
        current = child[near];
        continue;
      }
      if (entered[0] || entered[1]) {
        current = child[entered[0] ? 0 : 1];
        continue;
      }
    } else {
      for (uint32_t slot = current.first; slot < current.first + current.count; ++slot) {
        if (test_primitive(geometries, layout.slots[slot], prepared, best, counts) && kAny) return best;
      }
    }
    do {
      if (waiting == 0) return finished(best);
      current = stack[--waiting];
    } while (current.entry > best.t);
  }
}

const TraceTable& bvh2_table() { return kTraceTable<Bvh2Tracer>; }

}  // namespace kerf
