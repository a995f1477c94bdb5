#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <span>

#include "kerf/references/reference.h"

namespace kerf {

/// The cheapest place to divide few references by their centres, by the surface area heuristic: every place along each
/// axis is tried, which for so few takes a fraction of what binning takes. Most nodes of a tree have few.
class FewReferences {
 public:
  static constexpr uint32_t kMost = 8;

  /// Of at least two references, at most kMost.
  explicit FewReferences(std::span<const Reference> references) : references_(references) {
    for (uint32_t axis = 0; axis < 3; ++axis) try_axis(axis);
  }

  /// Area times count, both sides added; infinite: all centres are in one place.
  double cost() const { return cost_; }
  bool is_divided() const { return left_ > 0; }
  /// How many come first.
  uint32_t left() const { return left_; }
  /// The box of those that come first, and of the others, where they are divided.
  Box3f left_bounds() const { return bounds(0, left_); }
  Box3f right_bounds() const { return bounds(left_, references_.size()); }
  /// All of them, those that come first in front. `out` may be where they stand.
  void arrange(std::span<Reference> out) const {
    std::array<Reference, kMost> sorted;
    for (size_t i = 0; i < out.size(); ++i) sorted[i] = references_[best_[i]];
    std::copy_n(sorted.begin(), out.size(), out.begin());
  }

 private:
  using Order = std::array<uint8_t, kMost>;

  Box3f bounds(size_t begin, size_t end) const {
    Box3f box;
    for (size_t i = begin; i < end; ++i) box.extend(references_[best_[i]].bounds());
    return box;
  }

  void try_axis(uint32_t axis) {
    const size_t count = references_.size();
    std::array<float, kMost> keys;
    Order order;
    for (size_t i = 0; i < count; ++i) {
      const float key = references_[i].lower[axis] + references_[i].upper[axis];
      size_t place = i;
      for (; place > 0 && keys[place - 1] > key; --place) {
        keys[place] = keys[place - 1];
        order[place] = order[place - 1];
      }
      keys[place] = key;
      order[place] = static_cast<uint8_t>(i);
    }
    if (keys[0] == keys[count - 1]) return;
    std::array<double, kMost> right;
    Box3f box;
    for (size_t i = count - 1; i > 0; --i) {
      box.extend(references_[order[i]].bounds());
      right[i] = half_area(box) * static_cast<double>(count - i);
    }
    box = {};
    for (size_t i = 1; i < count; ++i) {
      box.extend(references_[order[i - 1]].bounds());
      const double cost = half_area(box) * static_cast<double>(i) + right[i];
      if (keys[i - 1] == keys[i] || !(cost < cost_)) continue;
      cost_ = cost;
      left_ = static_cast<uint32_t>(i);
      best_ = order;
    }
  }

  std::span<const Reference> references_;
  double cost_ = std::numeric_limits<double>::infinity();
  uint32_t left_ = 0;
  Order best_{};
};

}  // namespace kerf
