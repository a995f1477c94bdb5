#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <span>

#include "kerf/references/box4.h"

namespace kerf {

/// The cheapest place to divide few references by their centres, by the surface area heuristic: every place along each
/// axis is tried, which for so few takes a fraction of what binning takes. Most nodes of a tree have few.
class FewReferences {
 public:
  static constexpr uint32_t kMost = 8;

  /// Of at least two references, at most kMost.
  explicit FewReferences(std::span<const Reference> references) : references_(references) {
    if (references.size() == 2) {
      divide_two();
    } else {
      for (uint32_t axis = 0; axis < 3; ++axis) try_axis(axis);
    }
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
    Box4 box = Box4::empty();
    for (size_t i = begin; i < end; ++i) box.extend(Box4::of(references_[best_[i]]));
    return box.box();
  }

  float key(size_t i, uint32_t axis) const { return references_[i].lower[axis] + references_[i].upper[axis]; }

  /// Most often there are two, and the cost is the same along all axes.
  void divide_two() {
    for (uint32_t axis = 0; axis < 3; ++axis) {
      const float first = key(0, axis), second = key(1, axis);
      if (first == second) continue;
      cost_ = Box4::of(references_[0]).half_area() + Box4::of(references_[1]).half_area();
      left_ = 1;
      best_[0] = first < second ? 0 : 1;
      best_[1] = first < second ? 1 : 0;
      return;
    }
  }

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
    for (size_t i = 0; i < count; ++i) keys[i] = key(i, axis);
    Order order;
    put_in_order(keys, count, order);
    if (keys[order[0]] == keys[order[count - 1]]) return;
    std::array<double, kMost> right;
    Box4 box = Box4::of(references_[order[count - 1]]);
    for (size_t i = count - 1; i > 0; --i) {
      box.extend(Box4::of(references_[order[i]]));
      right[i] = box.half_area() * static_cast<double>(count - i);
    }
    box = Box4::of(references_[order[0]]);
    for (size_t i = 1; i < count; ++i) {
      box.extend(Box4::of(references_[order[i - 1]]));
      const double cost = box.half_area() * static_cast<double>(i) + right[i];
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
