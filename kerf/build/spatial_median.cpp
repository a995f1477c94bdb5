#include <array>

#include "kerf/build/builders.h"
#include "kerf/build/reference_order.h"

namespace kerf {
namespace {

class SpatialMedian : public ReferenceOrder {
 public:
  using ReferenceOrder::ReferenceOrder;

  /// The plane through the centre of the box, across its longest side; across the next where all centres lie on one
  /// side.
  std::optional<Halves> split(const Subset& subset) {
    const Vec3f extent = subset.bounds.extent();
    std::array<uint32_t, 3> axes{0, 1, 2};
    std::stable_sort(axes.begin(), axes.end(), [&](uint32_t a, uint32_t b) { return extent[a] > extent[b]; });
    for (const uint32_t axis : axes) {
      const float plane2 = subset.bounds.lower[axis] + subset.bounds.upper[axis];
      if (subset.centers.lower[axis] <= plane2 && plane2 < subset.centers.upper[axis]) {
        return partition(subset, [=](const Reference& r) { return center2(r, axis) <= plane2; });
      }
    }
    return std::nullopt;
  }
};

}  // namespace

Bvh build_spatial_median(BuildInput input, const OptionValues& options) {
  SpatialMedian partition(std::move(input.references));
  return build_top_down(partition, TopDownOptions::from(options), input.limit);
}

}  // namespace kerf
