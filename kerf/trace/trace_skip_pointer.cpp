#include "kerf/trace/trace_skip_pointer.h"

#include "kerf/base/fp_environment.h"
#include "kerf/trace/leaf.h"
#include "kerf/trace/ray_box.h"

namespace kerf {

template <bool kAny, class Counts>
Hit SkipPointerTracer::trace(const Ray& ray, Counts& counts) const {
  const StandardFloat standard;
  const PreparedRay prepared(ray);
  if (!prepared.valid || layout.nodes.empty()) return {};
  const BoxRay box_ray(prepared, layout.nodes[0].bounds());
  Hit best;
  best.t = prepared.t_max;
  const auto end = static_cast<uint32_t>(layout.nodes.size());
  for (uint32_t at = 0; at < end;) {
    const SkipPointerNode& node = layout.nodes[at];
    float entry = 0;
    counts.count_boxes(1);
    if (!box_ray.enters(node.sides(), prepared.t_min, best.t, entry)) {
      at = layout.after(at);
      continue;
    }
    counts.count_nodes(1);
    for (uint32_t slot = node.first; slot < node.first + node.count; ++slot) {  // of an inner node: none
      if (test_primitive(geometries, layout.slots[slot], prepared, best, counts) && kAny) return best;
    }
    ++at;
  }
  return finished(best);
}

const TraceTable& skip_pointer_table() { return kTraceTable<SkipPointerTracer>; }

}  // namespace kerf
