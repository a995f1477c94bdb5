#include "kerf/trace/trace_late_split.h"

#include <cassert>

#include "kerf/base/fp_environment.h"
#include "kerf/trace/leaf.h"
#include "kerf/trace/ray_box.h"

namespace kerf {
namespace {

/// A node that waits for its turn.
struct Waiting {
  uint32_t first = 0;
  LateSplitNode::Kind kind = LateSplitNode::kInner;
  float entry = 0;
};

}  // namespace

template <bool kAny, class Counts>
Hit LateSplitTracer::trace(const Ray& ray, Counts& counts) const {
  const StandardFloat standard;
  const PreparedRay prepared(ray);
  if (!prepared.valid || tree.is_empty()) return {};
  const BoxRay box_ray(prepared, tree.root.bounds());
  Hit best;
  best.t = prepared.t_max;
  Waiting current{tree.root.first, tree.root.kind, 0};
  counts.count_boxes(1);
  if (!box_ray.enters(tree.root.sides(), prepared.t_min, best.t, current.entry)) return {};
  Waiting stack[kMaxDepth];  // one node waits for each level above the current one, and there are at most so many
  uint32_t waiting = 0;
  uint32_t outside = 0;  // of those, how many lie outside the cut leaf that was entered last
  while (true) {
    counts.count_nodes(1);
    if (current.kind == LateSplitNode::kWholeLeaf || current.kind == LateSplitNode::kPiece) {
      if (test_primitive(geometries, tree.slots[current.first], prepared, best, counts) && kAny) return best;
      if (restores && current.kind == LateSplitNode::kPiece) waiting = outside;
    } else {
      if (current.kind == LateSplitNode::kCutLeaf) outside = waiting;
      const LateSplitPair& pair = tree.pairs[current.first];
      Waiting child[2];
      bool entered[2];
      counts.count_boxes(2);
      for (int i = 0; i < 2; ++i) {
        const LateSplitNode& c = pair.child[i];
        child[i] = {c.first, c.kind, 0};
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
    }
    do {
      if (waiting == 0) return finished(best);
      current = stack[--waiting];
    } while (current.entry > best.t);
  }
}

const TraceTable& late_split_table() { return kTraceTable<LateSplitTracer>; }

}  // namespace kerf
