#include "kerf/build/spatial_bins.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "kerf/base/parallel.h"
#include "kerf/references/box4.h"

namespace kerf {
namespace {

constexpr size_t kGrain = 4096;  // references that one task bins

/// A value for each slice along one axis, or for the plane below it. Only those of slices in use have a value.
template <class T>
using PerSlice = std::array<T, SpatialSlices::kMost>;

/// What is known of a slice without cutting: how many references have it as their first or last, and their boxes.
struct Tally {
  Box4 first, last;
  double first_count, last_count;

  static Tally empty() { return {Box4::empty(), Box4::empty(), 0, 0}; }
  void extend(const Tally& other) {
    first_count += other.first_count;
    last_count += other.last_count;
    first.extend(other.first);
    last.extend(other.last);
  }
};

/// fill(i, values) for the references i, blocks of them at once if they are many. Values are joined by extend(), in any
/// order with the same outcome.
template <class T, class Fill>
void fill_slices(size_t references, uint32_t slices, PerSlice<T>& values, Fill&& fill) {
  std::fill_n(values.begin(), slices, T::empty());
  const auto fill_some = [&](size_t begin, size_t end, PerSlice<T>& to) {
    for (size_t i = begin; i < end; ++i) fill(i, to);
  };
  if (references < 2 * kGrain) return fill_some(0, references, values);
  std::vector<PerSlice<T>> blocks((references + kGrain - 1) / kGrain, values);
  parallel_for(references, kGrain, [&](size_t begin, size_t end) { fill_some(begin, end, blocks[begin / kGrain]); });
  for (const PerSlice<T>& block : blocks) {
    for (uint32_t i = 0; i < slices; ++i) values[i].extend(block[i]);
  }
}

/// Half the area of what may be empty.
double area_of(const Box4& box) { return box.is_empty() ? 0 : box.half_area(); }

/// The search along one axis.
class AxisSearch {
 public:
  AxisSearch(std::span<const Reference> references, std::span<const float> weights, const SpatialSlices& slices,
             uint32_t axis, const Clipper& clipper, const SpatialLimits& limits)
      : references_(references), weights_(weights), slices_(slices), axis_(axis), clipper_(clipper), limits_(limits) {}

  /// Puts a cheaper plane than `best`, if there is one, into its place.
  void improve(SpatialPlane& best) {
    best.cost = std::min(best.cost, limits_.cost);
    count();
    find_candidates(best.cost);
    if (last_plane_ == 0) return;
    PerSlice<Box4> boxes;
    fill_slices(references_.size(), slices_.count(), boxes,
                [&](size_t i, PerSlice<Box4>& to) { add_pieces(references_[i], to); });
    compare(boxes, best);
  }

 private:
  void count() {
    fill_slices(references_.size(), slices_.count(), tallies_, [&](size_t i, PerSlice<Tally>& to) {
      const Reference& reference = references_[i];
      const Box4 box = Box4::of(reference);
      const SpatialSlices::Span span = slices_.span(reference, axis_);
      const double weight = weights_.empty() ? 1 : weights_[i];
      to[span.first].first_count += weight;
      to[span.first].first.extend(box);
      to[span.last].last_count += weight;
      to[span.last].last.extend(box);
    });
  }

  bool is_allowed(uint32_t plane) const {
    const double below = below_count_[plane], above = above_count_[plane];
    return below > 0 && above > 0 && below + above <= limits_.both && std::max(below, above) <= limits_.either;
  }

  /// The first and last plane that may be cheaper than `best`: not even the boxes of the references that need no cut
  /// there are too dear. Most planes, and often all, are ruled out so without cutting anything.
  void find_candidates(double best) {
    PerSlice<double> above_area;
    Box4 box = Box4::empty();
    double number = 0;
    for (uint32_t i = slices_.count() - 1; i > 0; --i) {
      box.extend(tallies_[i].first);
      above_count_[i] = number += tallies_[i].last_count;
      above_area[i] = area_of(box);
    }
    box = Box4::empty();
    number = 0;
    for (uint32_t i = 1; i < slices_.count(); ++i) {
      box.extend(tallies_[i - 1].last);
      below_count_[i] = number += tallies_[i - 1].first_count;
      const double least = area_of(box) * below_count_[i] + above_area[i] * above_count_[i];
      if (!is_allowed(i) || !(least < best)) continue;
      if (last_plane_ == 0) first_plane_ = i;
      last_plane_ = i;
    }
  }

  /// Adds what of a reference lies in each slice; what lies below the first plane that counts is taken for one slice,
  /// and so is what lies above the last. One cut in the middle tells how the primitive leans; its two parts are taken
  /// to fill their boxes: cutting at every plane costs three times as much and made trees 0.5 % better.
  void add_pieces(const Reference& reference, PerSlice<Box4>& boxes) const {
    SpatialSlices::Span span = slices_.span(reference, axis_);
    span.first = std::clamp(span.first, first_plane_ - 1, last_plane_);
    span.last = std::clamp(span.last, first_plane_ - 1, last_plane_);
    if (span.first == span.last) return boxes[span.first].extend(Box4::of(reference));
    const uint32_t middle = (span.first + span.last + 1) / 2;
    const ClippedBoxes parts = clipper_.guess(reference, axis_, slices_.plane(axis_, middle));
    add_box(parts.below, {span.first, middle - 1}, boxes);
    add_box(parts.above, {middle, span.last}, boxes);
  }

  void add_box(const Box3f& box, SpatialSlices::Span span, PerSlice<Box4>& boxes) const {
    if (box.is_empty()) return;
    Box3f part = box;
    for (uint32_t i = span.first; i <= span.last; ++i) {
      part.lower[axis_] = i > span.first ? std::max(box.lower[axis_], slices_.plane(axis_, i)) : box.lower[axis_];
      part.upper[axis_] = i < span.last ? std::min(box.upper[axis_], slices_.plane(axis_, i + 1)) : box.upper[axis_];
      if (part.lower[axis_] <= part.upper[axis_]) boxes[i].extend(Box4::of(part));
    }
  }

  void compare(const PerSlice<Box4>& boxes, SpatialPlane& best) const {
    PerSlice<Box4> above;
    Box4 box = Box4::empty();
    for (uint32_t i = last_plane_; i >= first_plane_; --i) {
      box.extend(boxes[i]);
      above[i] = box;
    }
    box = Box4::empty();
    for (uint32_t i = first_plane_; i <= last_plane_; ++i) {
      box.extend(boxes[i - 1]);
      if (!is_allowed(i)) continue;
      const double cost = area_of(box) * below_count_[i] + area_of(above[i]) * above_count_[i];
      if (!(cost < best.cost)) continue;
      best = {cost, axis_, slices_.plane(axis_, i), below_count_[i], above_count_[i], box.box(), above[i].box()};
    }
  }

  std::span<const Reference> references_;
  std::span<const float> weights_;
  const SpatialSlices& slices_;
  uint32_t axis_;
  const Clipper& clipper_;
  const SpatialLimits& limits_;
  PerSlice<Tally> tallies_;
  PerSlice<double> below_count_, above_count_;  // by plane; those across count on both sides
  uint32_t first_plane_ = 1, last_plane_ = 0;
};

}  // namespace

SpatialSlices::SpatialSlices(const Box3f& bounds, uint32_t count) : count_(count), first_(bounds.lower) {
  for (uint32_t axis = 0; axis < 3; ++axis) {
    const float width = (bounds.upper[axis] - bounds.lower[axis]) / static_cast<float>(count);
    scale_[axis] = 1 / width;
    usable_[axis] = std::isfinite(scale_[axis]);
    if (!usable_[axis]) continue;
    for (uint32_t i = 0; i < count; ++i) {
      planes_[axis][i] = std::min(bounds.lower[axis] + width * static_cast<float>(i), bounds.upper[axis]);
    }
    planes_[axis][count] = bounds.upper[axis];
  }
}

SpatialSlices::Span SpatialSlices::span(const Reference& reference, uint32_t axis) const {
  const float lower = reference.lower[axis], upper = reference.upper[axis];
  const float* planes = planes_[axis];
  const auto most = static_cast<float>(count_ - 1);
  const auto guess = [&](float x) {
    return static_cast<uint32_t>(static_cast<int32_t>(std::min((x - first_[axis]) * scale_[axis], most)));
  };
  uint32_t first = guess(lower), last = guess(upper);
  // Within the box nothing lies below plane 0 or above plane count().
  while (lower < planes[first]) --first;
  while (lower >= planes[first + 1] && first + 1 < count_) ++first;
  while (upper <= planes[last] && last > 0) --last;
  while (upper > planes[last + 1]) ++last;
  return {std::min(first, last), last};
}

SpatialPlane cheapest_spatial_plane(std::span<const Reference> references, std::span<const float> weights,
                                    const SpatialSlices& slices, const Clipper& clipper, const SpatialLimits& limits) {
  SpatialPlane best;
  for (uint32_t axis = 0; axis < 3; ++axis) {
    if (slices.is_usable(axis)) AxisSearch(references, weights, slices, axis, clipper, limits).improve(best);
  }
  return best;
}

}  // namespace kerf
