#include "kerf/trace/trace_bvh2.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <utility>

#include "kerf/base/fp_environment.h"
#include "kerf/trace/leaf.h"

namespace kerf {
namespace {

/// A child that waits for its turn.
struct Waiting {
  uint32_t first, count;
  float entry;
};

template <ChildOrder kOrder>
bool is_inner(uint32_t count) {
  return kOrder == ChildOrder::axis ? (count & Bvh2Child::kAxisMark) != 0 : count == 0;
}

/// One ray on its way.
template <ChildOrder kOrder, bool kAny, class BoxTest, class Counts>
struct Walk {
  const Bvh2TracerOf<kOrder, BoxTest>& tracer;
  const PreparedRay& ray;
  const BoxTest& box_ray;
  Hit& best;
  Counts& counts;

  /// The children of an inner node, and which of them the ray enters.
  void enter(const Waiting& inner, Waiting (&child)[2], bool (&entered)[2]) const {
    const Bvh2Node& node = tracer.layout.nodes[inner.first];
    counts.count_boxes(2);
    for (int i = 0; i < 2; ++i) {
      const Bvh2Child& c = node.child[i];
      child[i] = {c.first, c.count, 0};
      entered[i] = box_ray.enters(c.sides(), ray.t_min, best.t, child[i].entry);
    }
  }

  /// Whether the walk is over: any hit is enough.
  bool test_leaf(const Waiting& leaf) const {
    for (uint32_t slot = leaf.first; slot < leaf.first + leaf.count; ++slot) {
      if (test_primitive(tracer.geometries, tracer.layout.slots[slot], ray, best, counts) && kAny) return true;
    }
    return false;
  }

  int near_child(const Waiting& inner, const Waiting (&child)[2]) const {
    if constexpr (kOrder == ChildOrder::fixed) return 0;
    if constexpr (kOrder == ChildOrder::axis) {
      const bool is_negative = ray.direction_d[inner.count & Bvh2Child::kAxis] < 0;
      return is_negative != ((inner.count & Bvh2Child::kSecondIsLower) != 0) ? 1 : 0;
    }
    return child[1].entry < child[0].entry ? 1 : 0;
  }

  /// A subtree by a stack: from a node down to a leaf, the far children waiting.
  void depth_first(Waiting current) const {
    Waiting stack[kMaxDepth];  // one child waits for each level above the current one, and there are at most so many
    uint32_t waiting = 0;
    while (true) {
      counts.count_nodes(1);
      if (is_inner<kOrder>(current.count)) {
        Waiting child[2];
        bool entered[2];
        enter(current, child, entered);
        if (entered[0] && entered[1]) {
          const int near = near_child(current, child);
          assert(waiting < kMaxDepth);
          stack[waiting++] = child[1 - near];
          current = child[near];
          continue;
        }
        if (entered[0] || entered[1]) {
          current = child[entered[0] ? 0 : 1];
          continue;
        }
      } else if (test_leaf(current)) {
        return;
      }
      do {
        if (waiting == 0) return;
        current = stack[--waiting];
      } while (current.entry > best.t);
    }
  }

  /// All nodes by a heap: the nearest first, whatever its parent. A node for whose children the heap has no room is
  /// walked by the stack: the heap is bounded and nothing is dropped.
  void best_first(Waiting current) const {
    constexpr size_t kRoom = 32;
    const auto later = [](const Waiting& a, const Waiting& b) { return a.entry > b.entry; };
    std::array<Waiting, kRoom> heap;
    size_t waiting = 0;
    while (true) {
      if (!is_inner<kOrder>(current.count)) {
        counts.count_nodes(1);
        if (test_leaf(current)) return;
      } else if (waiting + 2 > kRoom) {
        depth_first(current);
        if (kAny && best) return;
      } else {
        counts.count_nodes(1);
        Waiting child[2];
        bool entered[2];
        enter(current, child, entered);
        for (int i = 0; i < 2; ++i) {
          if (!entered[i]) continue;
          heap[waiting++] = child[i];
          std::push_heap(heap.begin(), heap.begin() + waiting, later);
        }
      }
      if (waiting == 0) return;
      std::pop_heap(heap.begin(), heap.begin() + waiting, later);
      current = heap[--waiting];
      if (current.entry > best.t) return;
    }
  }
};

}  // namespace

template <ChildOrder kOrder, class BoxTest>
template <bool kAny, class Counts>
Hit Bvh2TracerOf<kOrder, BoxTest>::trace(const Ray& ray, Counts& counts) const {
  const StandardFloat standard;
  const PreparedRay prepared(ray);
  if (!prepared.valid || layout.is_empty()) return {};
  const BoxTest box_ray(prepared, layout.root.bounds());
  Hit best;
  best.t = prepared.t_max;
  Waiting root{layout.root.first, layout.root.count, 0};
  counts.count_boxes(1);
  if (!box_ray.enters(layout.root.sides(), prepared.t_min, best.t, root.entry)) return {};
  const Walk<kOrder, kAny, BoxTest, Counts> walk{*this, prepared, box_ray, best, counts};
  if constexpr (kOrder == ChildOrder::heap) {
    walk.best_first(root);
  } else {
    walk.depth_first(root);
  }
  return finished(best);
}

template <ChildOrder kOrder, class BoxTest>
const TraceTable& Bvh2TracerOf<kOrder, BoxTest>::table() {
  return kTraceTable<Bvh2TracerOf>;
}

template struct Bvh2TracerOf<ChildOrder::entry, BoxRay>;
template struct Bvh2TracerOf<ChildOrder::fixed, BoxRay>;
template struct Bvh2TracerOf<ChildOrder::axis, BoxRay>;
template struct Bvh2TracerOf<ChildOrder::heap, BoxRay>;
template struct Bvh2TracerOf<ChildOrder::entry, NaiveBoxRay>;
template struct Bvh2TracerOf<ChildOrder::entry, WilliamsBoxRay>;
template struct Bvh2TracerOf<ChildOrder::entry, PlueckerBoxRay>;
// For tracers that stand on this one.
template Hit Bvh2Tracer::trace<false>(const Ray&, NoCounts&) const;
template Hit Bvh2Tracer::trace<true>(const Ray&, NoCounts&) const;
template Hit Bvh2Tracer::trace<false>(const Ray&, TraceCounts&) const;
template Hit Bvh2Tracer::trace<true>(const Ray&, TraceCounts&) const;

}  // namespace kerf
