#include <array>
#include <cmath>

#include "kerf/build/builders.h"
#include "kerf/build/reference_order.h"

namespace kerf {
namespace {

constexpr uint32_t kMostBins = 256;
constexpr size_t kGrain = 32768;  // references that one task bins

/// The references whose centres lie in one slice of a node.
struct Bin {
  Box3f bounds;
  uint32_t count = 0;

  void add(const Bin& other) {
    bounds.extend(other.bounds);
    count += other.count;
  }
};

/// Which slice a reference's centre lies in, along each axis.
struct Slices {
  Vec3f first, scale;
  uint32_t bins;
  bool usable[3];

  Slices(const Box3f& centers, uint32_t bin_count) : first(centers.lower), bins(bin_count) {
    for (uint32_t axis = 0; axis < 3; ++axis) {
      scale[axis] = static_cast<float>(bins) / (centers.upper[axis] - centers.lower[axis]);
      usable[axis] = std::isfinite(scale[axis]);  // else all centres are equal, or as good as
    }
  }
  uint32_t operator()(const Reference& reference, uint32_t axis) const {
    const auto bin = static_cast<uint32_t>((center2(reference, axis) - first[axis]) * scale[axis]);
    return bin < bins ? bin : bins - 1;
  }
};

using Bins = std::array<std::array<Bin, kMostBins>, 3>;

void fill(std::span<const Reference> references, const Slices& slices, Bins& bins) {
  for (uint32_t axis = 0; axis < 3; ++axis) std::fill_n(bins[axis].begin(), slices.bins, Bin{});
  for (uint32_t axis = 0; axis < 3; ++axis) {
    if (!slices.usable[axis]) continue;
    for (const Reference& reference : references) {
      Bin& bin = bins[axis][slices(reference, axis)];
      bin.bounds.extend(reference.bounds());
      ++bin.count;
    }
  }
}

/// In parallel for large nodes: boxes and counts of blocks can be joined in any order with the same outcome.
void fill_parallel(std::span<const Reference> references, const Slices& slices, Bins& bins) {
  if (references.size() < 2 * kGrain) return fill(references, slices, bins);
  std::vector<Bins> blocks((references.size() + kGrain - 1) / kGrain);
  parallel_for(references.size(), kGrain, [&](size_t begin, size_t end) {
    fill(references.subspan(begin, end - begin), slices, blocks[begin / kGrain]);
  });
  bins = blocks[0];
  for (size_t b = 1; b < blocks.size(); ++b) {
    for (uint32_t axis = 0; axis < 3; ++axis) {
      for (uint32_t i = 0; i < slices.bins; ++i) bins[axis][i].add(blocks[b][axis][i]);
    }
  }
}

struct Plane {
  double cost = std::numeric_limits<double>::infinity();
  uint32_t axis = 0;
  uint32_t bin = 0;  ///< the first on the right
};

/// The plane between two bins with the least area times count, both sides added (Wald 2007).
Plane cheapest_plane(const Bins& bins, const Slices& slices) {
  Plane best;
  for (uint32_t axis = 0; axis < 3; ++axis) {
    if (!slices.usable[axis]) continue;
    std::array<double, kMostBins> right_cost;
    Bin right;
    for (uint32_t i = slices.bins - 1; i > 0; --i) {
      right.add(bins[axis][i]);
      right_cost[i] = half_area(right.bounds) * right.count;
      if (right.count == 0) right_cost[i] = std::numeric_limits<double>::infinity();
    }
    Bin left;
    for (uint32_t i = 1; i < slices.bins; ++i) {
      left.add(bins[axis][i - 1]);
      if (left.count == 0) continue;
      const double cost = half_area(left.bounds) * left.count + right_cost[i];
      if (cost < best.cost) best = {cost, axis, i};
    }
  }
  return best;
}

class BinnedSah : public ReferenceOrder {
 public:
  BinnedSah(std::vector<Reference> references, uint32_t bins) : ReferenceOrder(std::move(references)), bins_(bins) {}

  std::optional<Halves> split(const Subset& subset) {
    const Slices slices(subset.centers, bins_);
    Bins bins;
    fill_parallel(references(subset), slices, bins);
    const Plane plane = cheapest_plane(bins, slices);
    if (std::isinf(plane.cost)) return std::nullopt;
    return partition(subset, [&](const Reference& r) { return slices(r, plane.axis) < plane.bin; });
  }

 private:
  uint32_t bins_;
};

}  // namespace

Bvh build_binned_sah(std::vector<Reference> references, const OptionValues& options) {
  if (options.is_set("bins") && options.is_set("planes")) {
    throw Error(ErrorCode::invalid_option, "binned_sah",
                "bins and planes say the same thing (bins = planes + 1): give one");
  }
  const double bins = options.is_set("planes") ? options["planes"] + 1 : options["bins"];
  BinnedSah partition(std::move(references), static_cast<uint32_t>(bins));
  return build_top_down(partition, TopDownOptions::from(options));
}

}  // namespace kerf
