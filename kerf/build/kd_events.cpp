#include "kerf/build/kd_events.h"

#include <algorithm>

#include "kerf/base/parallel.h"
#include "kerf/base/work_limit.h"

namespace kerf {
namespace {

constexpr size_t kParallelCount = 16384;  // fewer references are not worth a task for each axis

template <class F>
void for_each_axis(size_t references, F&& f) {
  if (references < kParallelCount) {
    for (uint32_t axis = 0; axis < 3; ++axis) f(axis);
    return;
  }
  parallel_for(3, 1, [&](size_t begin, size_t end) {
    for (size_t axis = begin; axis < end; ++axis) f(static_cast<uint32_t>(axis));
  });
}

/// How the references of a cell lie about a plane that a sweep has reached.
struct Sweep {
  size_t begun = 0;   ///< that reach below the plane
  size_t beyond = 0;  ///< that reach above it
  size_t flat = 0;    ///< in it
};

KdPlane cheapest_plane(std::span<const KdEvent> events, size_t references, const Box3f& cell, const KdCosts& costs,
                       uint32_t axis) {
  KdPlane best;
  const KdAxisCost cost(costs, cell, axis);
  const float lower = cell.lower[axis], upper = cell.upper[axis];
  Sweep sweep{0, references, 0};
  for (size_t i = 0; i < events.size();) {
    const uint32_t at = events[i].ordered_position();
    const float position = events[i].position();
    size_t kinds[3] = {0, 0, 0};
    for (; i < events.size() && events[i].ordered_position() == at; ++i) ++kinds[events[i].kind()];
    sweep.flat = kinds[KdEvent::kFlat];
    sweep.beyond -= sweep.flat + kinds[KdEvent::kEnd];
    if (lower < position && position < upper) {
      const double flat_below = cost(position, sweep.begun + sweep.flat, sweep.beyond);
      const double flat_above = cost(position, sweep.begun, sweep.beyond + sweep.flat);
      if (flat_below < best.cost) best = {flat_below, axis, position, true};
      if (flat_above < best.cost) best = {flat_above, axis, position, false};
    }
    sweep.begun += sweep.flat + kinds[KdEvent::kBegin];
  }
  return best;
}

/// Hands on the events of references on one side, in order, and merges in those of cut ones.
std::vector<KdEvent> half_of(std::span<const KdEvent> events, std::span<const KdTarget> targets,
                             std::span<const KdCutBox> cut, uint32_t axis, uint32_t side) {
  std::vector<KdEvent> kept(events.size() + 1);  // the place at the end is written to and never kept
  size_t count = 0;
  for (const KdEvent event : events) {
    const KdTarget target = targets[event.reference()];
    kept[count] = event.renumbered(target.number());
    count += target.side() == side ? 1 : 0;
  }
  kept.resize(count);
  if (cut.empty()) return kept;
  std::vector<KdEvent> fresh;
  fresh.reserve(2 * cut.size());
  for (const KdCutBox& piece : cut) append_events(piece.box, axis, piece.reference, fresh);
  std::sort(fresh.begin(), fresh.end());
  std::vector<KdEvent> all(kept.size() + fresh.size());
  std::merge(kept.begin(), kept.end(), fresh.begin(), fresh.end(), all.begin());
  return all;
}

}  // namespace

void append_events(const Box3f& box, uint32_t axis, uint32_t reference, std::vector<KdEvent>& events) {
  const float lower = box.lower[axis], upper = box.upper[axis];
  if (lower == upper) {
    events.emplace_back(lower, KdEvent::kFlat, reference);
  } else {
    events.emplace_back(lower, KdEvent::kBegin, reference);
    events.emplace_back(upper, KdEvent::kEnd, reference);
  }
}

KdEvents make_events(std::span<const Reference> references) {
  KdEvents events;
  for_each_axis(references.size(), [&](uint32_t axis) {
    events[axis].reserve(2 * references.size());
    for (uint32_t i = 0; i < references.size(); ++i) append_events(references[i].bounds(), axis, i, events[axis]);
    LimitWatch watch;
    std::sort(events[axis].begin(), events[axis].end(), [&](const KdEvent& a, const KdEvent& b) {
      watch.step();
      return a < b;
    });
  });
  return events;
}

KdPlane cheapest_plane(const KdEvents& events, size_t references, const Box3f& cell, const KdCosts& costs) {
  std::array<KdPlane, 3> planes;
  for_each_axis(references,
                [&](uint32_t axis) { planes[axis] = cheapest_plane(events[axis], references, cell, costs, axis); });
  const auto cheaper = [](const KdPlane& a, const KdPlane& b) { return a.cost < b.cost; };
  return *std::min_element(planes.begin(), planes.end(), cheaper);
}

KdEventHalves divide_events(const KdEvents& events, std::span<const KdTarget> targets,
                            std::span<const KdCutBox> cut_below, std::span<const KdCutBox> cut_above) {
  KdEventHalves halves;
  for_each_axis(targets.size(), [&](uint32_t axis) {
    halves.below[axis] = half_of(events[axis], targets, cut_below, axis, KdTarget::kBelow);
    halves.above[axis] = half_of(events[axis], targets, cut_above, axis, KdTarget::kAbove);
  });
  return halves;
}

}  // namespace kerf
