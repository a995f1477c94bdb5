#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <span>

#include "kerf/base/float4.h"
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

  /// Half the area of a box in registers.
  static double area(Float4 lower, Float4 upper) {
    const Float4 extent = upper - lower;
    const double x = extent[0], y = extent[1], z = extent[2];
    return x * (y + z) + y * z;
  }
  Float4 lower(size_t i) const { return load4(&references_[i].lower.x); }
  Float4 upper(size_t i) const { return load4(&references_[i].upper.x); }

  /// Where each of the keys goes: behind all that are less, and those equal to it before it.
  static void put_in_order(const std::array<float, kMost>& keys, size_t count, Order& order) {
    std::array<uint8_t, kMost> place{};
    for (uint32_t i = 1; i < count; ++i) {
      for (uint32_t j = 0; j < i; ++j) {
        const bool stays = keys[j] <= keys[i];
        place[i] += stays ? 1 : 0;
        place[j] += stays ? 0 : 1;
      }
    }
    for (uint32_t i = 0; i < count; ++i) order[place[i]] = static_cast<uint8_t>(i);
  }

  void try_axis(uint32_t axis) {
    const size_t count = references_.size();
    std::array<float, kMost> keys;
    for (size_t i = 0; i < count; ++i) keys[i] = references_[i].lower[axis] + references_[i].upper[axis];
    Order order;
    put_in_order(keys, count, order);
    if (keys[order[0]] == keys[order[count - 1]]) return;
    std::array<double, kMost> right;
    Float4 from = lower(order[count - 1]), to = upper(order[count - 1]);
    for (size_t i = count - 1; i > 0; --i) {
      from = min(lower(order[i]), from);
      to = max(upper(order[i]), to);
      right[i] = area(from, to) * static_cast<double>(count - i);
    }
    from = lower(order[0]);
    to = upper(order[0]);
    for (size_t i = 1; i < count; ++i) {
      from = min(lower(order[i - 1]), from);
      to = max(upper(order[i - 1]), to);
      const double cost = area(from, to) * static_cast<double>(i) + right[i];
      if (keys[order[i - 1]] == keys[order[i]] || !(cost < cost_)) continue;
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
