#pragma once

#include <cstddef>

#include "kerf/base/box3.h"
#include "kerf/base/float4.h"
#include "kerf/references/reference.h"

namespace kerf {

static_assert(offsetof(Reference, lower) == 0 && offsetof(Reference, upper) == 16, "loaded as registers");

/// A box in two registers, to gather many references in; the fourth lanes mean nothing. Without initial values: nodes
/// use few of the bins that there may be, and setting all of them up was measured at a quarter of a build.
struct Box4 {
  Float4 lower, upper;

  static Box4 of(const Reference& reference) { return {load4(&reference.lower.x), load4(&reference.upper.x)}; }
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
  Box4 intersected(const Box4& other) const { return {max(other.lower, lower), min(other.upper, upper)}; }
  Box3f box() const { return {{lower[0], lower[1], lower[2]}, {upper[0], upper[1], upper[2]}}; }
  bool is_empty() const { return lower[0] > upper[0]; }

  /// Half the surface area; of one that is not empty.
  double half_area() const {
    const Float4 extent = upper - lower;
    const double x = extent[0], y = extent[1], z = extent[2];
    return x * (y + z) + y * z;
  }
};

}  // namespace kerf
