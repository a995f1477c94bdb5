#pragma once

#include <cstddef>

#include "kerf/base/box3.h"
#include "kerf/base/float4.h"

namespace kerf {

/// A box in two registers, to gather many references in; the fourth lanes mean nothing. Without initial values: nodes
/// use few of the bins that there may be, and setting all of them up was measured at a quarter of a build.
struct Box4 {
  Float4 lower, upper;

  /// Of a Reference, or what is laid out as one.
  template <class T>
  requires(alignof(T) >= 16 && offsetof(T, lower) == 0 && offsetof(T, upper) == 16) static Box4 of(const T& boxed) {
    return {load4(&boxed.lower.x), load4(&boxed.upper.x)};
  }
  static Box4 of(const Box3f& b) {
    return {Float4{b.lower.x, b.lower.y, b.lower.z, 0}, Float4{b.upper.x, b.upper.y, b.upper.z, 0}};
  }
  static Box4 empty() {
    constexpr float kInfinity = Box3f::kInfinity;
    const Float4 all{kInfinity, kInfinity, kInfinity, kInfinity};
    return {all, -all};
  }

  void extend(const Box4& other) {
    lower = min(other.lower, lower);
    upper = max(other.upper, upper);
  }
  Box4 united(const Box4& other) const { return {min(other.lower, lower), max(other.upper, upper)}; }
  Box4 intersected(const Box4& other) const { return {max(other.lower, lower), min(other.upper, upper)}; }
  Box3f box() const { return {{lower[0], lower[1], lower[2]}, {upper[0], upper[1], upper[2]}}; }
  bool contains(const Box4& other) const {
    const auto lanes = (lower <= other.lower) & (upper >= other.upper);
    return (lanes[0] & lanes[1] & lanes[2]) != 0;
  }
  bool is_empty() const { return lower[0] > upper[0]; }

  /// Half the surface area; of one that is not empty.
  double half_area() const {
    const Float4 extent = upper - lower;
    const double x = extent[0], y = extent[1], z = extent[2];
    return x * (y + z) + y * z;
  }
};

}  // namespace kerf
