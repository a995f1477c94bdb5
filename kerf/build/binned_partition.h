#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "kerf/build/reference_order.h"
#include "kerf/references/box4.h"

namespace kerf {
namespace detail {

inline constexpr uint32_t kMostBins = 256;
inline constexpr size_t kBinGrain = 32768;  // references that one task bins

/// How many slices a node of so many references is worth, at most `most`.
inline uint32_t bins_for(uint32_t references, uint32_t most) {
  constexpr uint32_t kFewest = 8, kEach = 8;
  return std::min(most, kFewest + references / kEach);
}

/// The references whose centres lie in one slice of a node.
struct Bin {
  Box4 box;
  uint32_t count;

  void clear() {
    box = Box4::empty();
    count = 0;
  }
  void add(const Box4& reference) {
    box.extend(reference);
    ++count;
  }
  void add(const Bin& other) {
    box.extend(other.box);
    count += other.count;
  }
  /// Half the area times count; not of an empty one.
  double cost() const { return box.half_area() * count; }
};

/// Which slice a reference's centre lies in, along each axis.
struct Slices {
  Float4 first, scale;
  Float4 last;  ///< the number of the last slice
  uint32_t bins;
  bool usable[3];

  Slices(const Box3f& centers, uint32_t bin_count) : first{}, scale{}, bins(bin_count) {
    const auto count = static_cast<float>(bins);
    last = Float4{count, count, count, count} - 1;
    for (uint32_t axis = 0; axis < 3; ++axis) {
      const float per_length = count / (centers.upper[axis] - centers.lower[axis]);
      usable[axis] = std::isfinite(per_length);  // else all centres are equal, or as good as
      first[axis] = centers.lower[axis];
      scale[axis] = usable[axis] ? per_length : 0;
    }
  }
  /// A number of the slice along each axis and a fraction.
  Float4 places(Float4 center2) const { return min((center2 - first) * scale, last); }
};

using Bins = std::array<std::array<Bin, kMostBins>, 3>;

inline void fill(std::span<const Reference> references, const Slices& slices, Bins& bins) {
  for (auto& line : bins) std::for_each_n(line.begin(), slices.bins, [](Bin& bin) { bin.clear(); });
  for (const Reference& reference : references) {
    const Box4 box = Box4::of(reference);
    const Float4 places = slices.places(box.lower + box.upper);
    for (uint32_t axis = 0; axis < 3; ++axis) {
      bins[axis][static_cast<uint32_t>(static_cast<int32_t>(places[axis]))].add(box);
    }
  }
}

/// In parallel for large nodes: boxes and counts of blocks can be joined in any order with the same outcome.
inline void fill_parallel(std::span<const Reference> references, const Slices& slices, Bins& bins) {
  if (references.size() < 2 * kBinGrain) return fill(references, slices, bins);
  std::vector<Bins> blocks((references.size() + kBinGrain - 1) / kBinGrain);
  parallel_for(references.size(), kBinGrain, [&](size_t begin, size_t end) {
    fill(references.subspan(begin, end - begin), slices, blocks[begin / kBinGrain]);
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
inline Plane cheapest_plane(const Bins& bins, const Slices& slices) {
  Plane best;
  for (uint32_t axis = 0; axis < 3; ++axis) {
    if (!slices.usable[axis]) continue;
    std::array<double, kMostBins> right_cost;
    Bin right;
    right.clear();
    for (uint32_t i = slices.bins - 1; i > 0; --i) {
      right.add(bins[axis][i]);
      right_cost[i] = right.count > 0 ? right.cost() : std::numeric_limits<double>::infinity();
    }
    Bin left;
    left.clear();
    for (uint32_t i = 1; i < slices.bins; ++i) {
      left.add(bins[axis][i - 1]);
      if (left.count == 0) continue;
      const double cost = left.cost() + right_cost[i];
      if (cost < best.cost) best = {cost, axis, i};
    }
  }
  return best;
}

/// Whether a reference's centre lies below a plane.
class BelowPlane {
 public:
  BelowPlane(const Slices& slices, const Plane& plane)
      : axis_(plane.axis),
        first_(slices.first[axis_]),
        scale_(slices.scale[axis_]),
        bin_(static_cast<float>(plane.bin)) {}

  bool operator()(const Reference& reference) const { return (center2(reference, axis_) - first_) * scale_ < bin_; }

 private:
  uint32_t axis_;
  float first_, scale_, bin_;
};

}  // namespace detail

/// The cheapest plane between slices of equal width, by the surface area heuristic (Wald 2007).
class BinnedSah : public ReferenceOrder {
 public:
  BinnedSah(std::vector<Reference> references, uint32_t bins) : ReferenceOrder(std::move(references)), bins_(bins) {}

  std::optional<Halves> split(const Subset& subset) {
    if (subset.count() <= std::min(bins_, FewReferences::kMost)) {
      const FewReferences division(references(subset));
      return division.is_divided() ? std::optional(arrange(subset, division)) : std::nullopt;
    }
    const detail::Slices slices(subset.centers, detail::bins_for(subset.count(), bins_));
    detail::Bins bins;
    detail::fill_parallel(references(subset), slices, bins);
    const detail::Plane plane = detail::cheapest_plane(bins, slices);
    if (std::isinf(plane.cost)) return std::nullopt;
    return partition(subset, detail::BelowPlane(slices, plane));
  }

 private:
  uint32_t bins_;
};

}  // namespace kerf
