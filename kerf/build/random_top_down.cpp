#include <array>
#include <limits>

#include "kerf/base/mix.h"
#include "kerf/build/builders.h"
#include "kerf/build/reference_order.h"

namespace kerf {
namespace {

/// A plane across an axis: references whose lower + upper lies below it go left.
struct Plane {
  uint32_t axis = 0;
  float position2 = 0;

  bool goes_left(const Reference& reference) const { return center2(reference, axis) < position2; }
};

/// Tries a few planes that look random: through the box of the centres, across an axis along which they differ. The
/// choice is a function of the seed and the subset, so that it does not matter which thread comes first.
class RandomPlanes : public ReferenceOrder {
 public:
  RandomPlanes(std::vector<Reference> references, uint64_t seed, uint32_t candidates)
      : ReferenceOrder(std::move(references)), seed_(seed), candidates_(candidates) {}

  std::optional<Halves> split(const Subset& subset) {
    std::array<uint32_t, 3> axes{};
    uint32_t axis_count = 0;
    for (uint32_t axis = 0; axis < 3; ++axis) {
      if (subset.centers.lower[axis] < subset.centers.upper[axis]) axes[axis_count++] = axis;
    }
    if (axis_count == 0) return std::nullopt;
    std::vector<Plane> planes(candidates_);
    std::vector<double> costs(candidates_);
    const uint64_t seed = mix(seed_, uint64_t{subset.begin} << 32 | subset.end);
    parallel_for(candidates_, subset.count() >= kParallelCount ? 1 : candidates_, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        planes[i] = plane(subset.centers, mix(seed, i), {axes.data(), axis_count});
        costs[i] = cost(subset, planes[i]);
      }
    });
    const Plane& best = planes[static_cast<size_t>(std::min_element(costs.begin(), costs.end()) - costs.begin())];
    return partition(subset, [&](const Reference& reference) { return best.goes_left(reference); });
  }

 private:
  static constexpr uint32_t kParallelCount = 16384;  // fewer references are not worth a task

  /// Above the lowest centre and not above the highest, so that something lies on either side.
  static Plane plane(const Box3f& centers, uint64_t random, std::span<const uint32_t> axes) {
    const uint32_t axis = axes[random % axes.size()];
    const float share = static_cast<float>((random >> 40) + 1) * 0x1p-24F;
    const float lower = centers.lower[axis], upper = centers.upper[axis];
    const float position = lower + share * (upper - lower);
    return {axis, position > lower && position < upper ? position : upper};
  }

  /// Area times count, both sides added.
  double cost(const Subset& subset, const Plane& plane) const {
    Box3f left, right;
    uint32_t left_count = 0;
    for (const Reference& reference : references(subset)) {
      const bool is_left = plane.goes_left(reference);
      (is_left ? left : right).extend(reference.bounds());
      left_count += is_left ? 1 : 0;
    }
    return half_area(left) * left_count + half_area(right) * (subset.count() - left_count);
  }

  uint64_t seed_;
  uint32_t candidates_;
};

}  // namespace

Bvh build_random_top_down(BuildInput input, const OptionValues& options) {
  RandomPlanes partition(std::move(input.references), static_cast<uint64_t>(options["seed"]),
                         static_cast<uint32_t>(options["candidates"]));
  return build_top_down(partition, TopDownOptions::from(options), input.limit);
}

}  // namespace kerf
