#include "kerf/trace/trace_uniform_grid.h"

#include "kerf/base/fp_environment.h"
#include "kerf/trace/grid_walk.h"
#include "kerf/trace/leaf.h"
#include "kerf/trace/mailbox.h"

namespace kerf {

template <class Seen>
template <bool kAny, class Counts>
Hit UniformGridTracer<Seen>::trace(const Ray& ray, Counts& counts) const {
  const StandardFloat standard;
  const PreparedRay prepared(ray);
  if (!prepared.valid || grid.is_empty()) return {};
  const Box3f bounds = grid.bounds();
  const BoxRay box_ray(prepared, bounds);
  const float sides[] = {bounds.lower.x, bounds.lower.y, bounds.lower.z, 0,
                         bounds.upper.x, bounds.upper.y, bounds.upper.z};
  Hit best;
  best.t = prepared.t_max;
  float entry = 0;
  counts.count_boxes(1);
  if (!box_ray.enters(sides, prepared.t_min, best.t, entry)) return {};
  counts.count_nodes(1);
  Seen seen;
  GridWalk walk(grid, prepared, box_ray, entry);
  walk.run(best.t, [&](size_t cell) {
    counts.count_nodes(1);
    for (const LeafSlot& slot : grid.slots_of(cell)) {
      if (slot.is_repeated() && seen.has_seen(slot)) continue;
      if (test_primitive(geometries, slot, prepared, best, counts) && kAny) return false;
    }
    return true;
  });
  return finished(best);
}

const TraceTable& uniform_grid_table(bool mailbox) {
  return mailbox ? kTraceTable<UniformGridTracer<Mailbox>> : kTraceTable<UniformGridTracer<NoMailbox>>;
}

}  // namespace kerf
