#include "kerf/build/kd_cell.h"

#include "kerf/base/parallel.h"

namespace kerf {
namespace {

constexpr size_t kGrain = 512;  // references that one task cuts

ClippedBoxes cut_box(const Reference& reference, const KdPlane& plane) {
  ClippedBoxes boxes{reference.bounds(), reference.bounds()};
  boxes.below.upper[plane.axis] = plane.position;
  boxes.above.lower[plane.axis] = plane.position;
  return boxes;
}

/// The boxes of the parts of a reference; at least one is not empty.
ClippedBoxes cut(const Reference& reference, const KdPlane& plane, const Clipper* clipper) {
  if (clipper == nullptr) return cut_box(reference, plane);
  ClippedBoxes boxes = (*clipper)(reference, plane.axis, plane.position);
  if (boxes.below.is_empty() && boxes.above.is_empty()) return cut_box(reference, plane);  // only rounding can do that
  return boxes;
}

bool is_across(const Reference& reference, const KdPlane& plane) {
  return reference.lower[plane.axis] < plane.position && plane.position < reference.upper[plane.axis];
}

bool goes_below(const Reference& reference, const KdPlane& plane) {
  const float lower = reference.lower[plane.axis], upper = reference.upper[plane.axis];
  if (lower == upper && lower == plane.position) return plane.flat_go_below;
  return upper <= plane.position;
}

std::vector<ClippedBoxes> cut_all(const KdCell& cell, std::span<const uint32_t> across, const KdPlane& plane,
                                  const Clipper* clipper) {
  std::vector<ClippedBoxes> parts(across.size());
  const auto cut_some = [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) parts[i] = cut(cell.references[across[i]], plane, clipper);
  };
  if (across.size() <= kGrain) {  // most often: not worth asking for tasks
    cut_some(0, across.size());
  } else {
    parallel_for(across.size(), kGrain, cut_some);
  }
  return parts;
}

Reference with_box(Reference reference, const Box3f& box) {
  reference.lower = box.lower;
  reference.upper = box.upper;
  return reference;
}

/// One half while it is filled.
struct Half {
  KdCell& cell;
  std::vector<KdCutBox> cut;

  uint32_t next() const { return static_cast<uint32_t>(cell.references.size()); }
  void add(const Reference& reference) { cell.references.push_back(reference); }
  void add_part(const Reference& reference, const Box3f& box) {
    if (box.is_empty()) return;
    cut.push_back({box, next()});
    add(with_box(reference, box));
  }
};

void share(uint64_t allowed, KdCell& below, KdCell& above) {
  const uint64_t b = below.references.size(), a = above.references.size();
  if (b + a == 0 || b + a > allowed) return;  // the caller makes a leaf
  const uint64_t spare = allowed - b - a;
  below.allowed = b + spare / (b + a) * b + spare % (b + a) * b / (b + a);
  above.allowed = allowed - below.allowed;
}

}  // namespace

KdHalves divide(const KdCell& cell, const KdPlane& plane, const Clipper* clipper) {
  KdHalves halves;
  halves.below.bounds = cell.bounds;
  halves.above.bounds = cell.bounds;
  halves.below.bounds.upper[plane.axis] = plane.position;
  halves.above.bounds.lower[plane.axis] = plane.position;
  halves.below.depth = halves.above.depth = cell.depth + 1;
  halves.below.has_events = halves.above.has_events = cell.has_events;

  std::vector<uint32_t> across;
  size_t whole_below = 0;
  for (uint32_t i = 0; i < cell.references.size(); ++i) {
    if (is_across(cell.references[i], plane)) {
      across.push_back(i);
    } else {
      whole_below += goes_below(cell.references[i], plane) ? 1 : 0;
    }
  }
  halves.cuts = across.size();
  const std::vector<ClippedBoxes> parts = cut_all(cell, across, plane, clipper);

  Half below{halves.below, {}}, above{halves.above, {}};
  below.cell.references.reserve(whole_below + across.size());
  above.cell.references.reserve(cell.references.size() - whole_below);
  std::vector<KdTarget> targets(cell.references.size());
  size_t next_across = 0;
  for (uint32_t i = 0; i < cell.references.size(); ++i) {
    const Reference& reference = cell.references[i];
    if (next_across < across.size() && across[next_across] == i) {
      targets[i] = KdTarget(KdTarget::kCut, 0);
      below.add_part(reference, parts[next_across].below);
      above.add_part(reference, parts[next_across].above);
      ++next_across;
      continue;
    }
    const bool goes = goes_below(reference, plane);
    Half& half = goes ? below : above;
    targets[i] = KdTarget(goes ? KdTarget::kBelow : KdTarget::kAbove, half.next());
    half.add(reference);
  }
  if (cell.has_events) {
    KdEventHalves events = divide_events(cell.events, targets, below.cut, above.cut);
    halves.below.events = std::move(events.below);
    halves.above.events = std::move(events.above);
  }
  share(cell.allowed, halves.below, halves.above);
  return halves;
}

}  // namespace kerf
