#pragma once

#include <algorithm>
#include <tuple>
#include <vector>

#include "kerf/build/few_references.h"
#include "kerf/build/side_by_side.h"
#include "kerf/build/top_down.h"

namespace kerf {

/// Twice the centre of a reference's box along an axis: all that a partition compares, without a rounding to halve it.
inline float center2(const Reference& reference, uint32_t axis) {
  return reference.lower[axis] + reference.upper[axis];
}

/// References that are reordered in place: the base of the partitions that need no sorting.
class ReferenceOrder {
 public:
  explicit ReferenceOrder(std::vector<Reference> references)
      : references_(std::move(references)), held_(references_.capacity() * sizeof(Reference)) {}

  Subset whole() const { return detail::measured(references_, 0, static_cast<uint32_t>(references_.size())); }

  const Reference& reference(uint32_t i) const { return references_[i]; }
  void free_references() {
    std::vector<Reference>().swap(references_);
    held_.release();
  }

  /// Equal counts along the axis where the centres spread most. Ties are broken by primitive, so the outcome is one.
  Halves halve(const Subset& subset) {
    const uint32_t axis = largest_axis(subset.centers.extent());
    const auto key = [axis](const Reference& r) {
      return std::make_tuple(center2(r, axis), r.geometry, r.primitive, r.lower.x, r.lower.y, r.lower.z);
    };
    const uint32_t middle = subset.begin + subset.count() / 2;
    std::nth_element(references_.begin() + subset.begin, references_.begin() + middle, references_.begin() + subset.end,
                     [&](const Reference& a, const Reference& b) { return key(a) < key(b); });
    return halves_at(subset, middle);
  }

 protected:
  /// The two parts as the references stand.
  Halves halves_at(const Subset& subset, uint32_t middle) const {
    return {detail::measured(references_, subset.begin, middle), detail::measured(references_, middle, subset.end)};
  }

  std::span<const Reference> references(const Subset& subset) const {
    return {references_.data() + subset.begin, subset.count()};
  }

  /// References for which goes_left() holds come first.
  template <class F>
  Halves partition(const Subset& subset, F&& goes_left) {
    return detail::put_side_by_side(references_, subset, goes_left);
  }

  /// As few references are best divided; they must be.
  Halves arrange(const Subset& subset, const FewReferences& division) {
    division.arrange({references_.data() + subset.begin, subset.count()});
    return halves_at(subset, subset.begin + division.left());
  }

  std::vector<Reference> references_;
  HeldBytes held_;
};

}  // namespace kerf
