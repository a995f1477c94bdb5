#include "kerf/build/kd_samples.h"

#include <algorithm>
#include <array>

#include "kerf/base/parallel.h"

namespace kerf {
namespace {

constexpr size_t kMostPositions = 2 * kMostKdSamples + 2;
constexpr size_t kParallelCount = 16384;  // fewer references are not worth a task for each axis

/// Positions along an axis in ascending order, and how many references lie how about each.
struct Samples {
  std::array<float, kMostPositions> position;
  std::array<uint32_t, kMostPositions + 1> below, above, flat;  ///< reach below, reach above, lie in the plane
  size_t count = 0;

  void add(float x) { position[count++] = x; }

  void sort() {
    const auto end = position.begin() + static_cast<ptrdiff_t>(count);
    std::sort(position.begin(), end);
    count = static_cast<size_t>(std::unique(position.begin(), end) - position.begin());
  }

  void scan(std::span<const Reference> references, uint32_t axis) {
    std::fill_n(below.begin(), count + 1, 0);
    std::fill_n(above.begin(), count + 1, 0);
    std::fill_n(flat.begin(), count + 1, 0);
    for (const Reference& reference : references) {
      const float lower = reference.lower[axis], upper = reference.upper[axis];
      uint32_t up_to_lower = 0, before_upper = 0;  // positions; counted through, which is faster than a search
      for (size_t i = 0; i < count; ++i) {
        up_to_lower += position[i] <= lower ? 1 : 0;
        before_upper += position[i] < upper ? 1 : 0;
      }
      ++below[up_to_lower];
      ++above[before_upper];
      if (lower == upper && before_upper < up_to_lower) ++flat[before_upper];
    }
    // So far counted where they change.
    for (size_t i = 1; i < count; ++i) below[i] += below[i - 1];
    uint32_t not_above = 0;
    for (size_t i = 0; i < count; ++i) {
      not_above += above[i];
      above[i] = static_cast<uint32_t>(references.size()) - not_above;
    }
  }
};

/// Adds positions where equal shares of all comings and goings have passed.
void refine(Samples& samples, size_t references, uint32_t extra) {
  const size_t first_count = samples.count;
  const size_t total = 2 * references;
  size_t next = 0;  // the level to place
  std::array<uint32_t, kMostPositions> placed{};
  for (size_t segment = 0; segment + 1 < first_count; ++segment) {
    const auto passed = [&](size_t i) { return samples.below[i] + (references - samples.above[i]); };
    while (next < extra && (next + 1) * total <= passed(segment + 1) * (size_t{extra} + 1)) {
      ++placed[segment];
      ++next;
    }
  }
  for (size_t segment = 0; segment + 1 < first_count; ++segment) {
    const double from = samples.position[segment], to = samples.position[segment + 1];
    for (uint32_t i = 0; i < placed[segment]; ++i) {
      samples.add(static_cast<float>(from + (to - from) * (i + 1) / (placed[segment] + 1)));
    }
  }
}

KdPlane cheapest_along(std::span<const Reference> references, const Box3f& cell, const KdCosts& costs, uint32_t count,
                       uint32_t axis) {
  float lower = cell.upper[axis], upper = cell.lower[axis];
  for (const Reference& reference : references) {
    lower = std::min(lower, reference.lower[axis]);
    upper = std::max(upper, reference.upper[axis]);
  }
  Samples samples;
  samples.add(lower);
  for (uint32_t i = 0; i < count; ++i) {
    samples.add(static_cast<float>(lower + (double{upper} - lower) * (i + 1) / (count + 1)));
  }
  samples.add(upper);
  samples.sort();
  samples.scan(references, axis);
  refine(samples, references.size(), count);
  samples.sort();
  samples.scan(references, axis);
  KdPlane best;
  const KdAxisCost cost(costs, cell, axis);
  for (size_t i = 0; i < samples.count; ++i) {
    const float x = samples.position[i];
    if (!(cell.lower[axis] < x && x < cell.upper[axis])) continue;
    const double flat_below = cost(x, samples.below[i] + samples.flat[i], samples.above[i]);
    const double flat_above = cost(x, samples.below[i], samples.above[i] + samples.flat[i]);
    if (flat_below < best.cost) best = {flat_below, axis, x, true};
    if (flat_above < best.cost) best = {flat_above, axis, x, false};
  }
  return best;
}

}  // namespace

KdPlane cheapest_sampled_plane(std::span<const Reference> references, const Box3f& cell, const KdCosts& costs,
                               uint32_t samples) {
  std::array<KdPlane, 3> planes;
  parallel_for(3, references.size() >= kParallelCount ? 1 : 3, [&](size_t begin, size_t end) {
    for (size_t axis = begin; axis < end; ++axis) {
      planes[axis] = cheapest_along(references, cell, costs, samples, static_cast<uint32_t>(axis));
    }
  });
  const auto cheaper = [](const KdPlane& a, const KdPlane& b) { return a.cost < b.cost; };
  return *std::min_element(planes.begin(), planes.end(), cheaper);
}

}  // namespace kerf
