#pragma once

#include <span>
#include <vector>

namespace kerf::report {

enum class AxisKind {
  from_zero,    ///< linear, and begins at 0
  linear,       ///< around the values
  logarithmic,  ///< only what is above 0 can stand on it
};

/// What an axis shows: where it begins and ends, both at 1, 2 or 5 times a power of ten or at a multiple of that.
struct Axis {
  AxisKind kind = AxisKind::linear;
  double least = 0, most = 1;
  std::vector<double> ticks;  ///< ascending: 1, 2 or 5 times a power of ten, or powers of ten alone

  /// Whether a value has a place on such an axis.
  bool holds(double value) const;
  /// From 0 to 1 for values from least to most.
  double place(double value) const;
};

/// An axis that has room for all of the values that can stand on it, with about `ticks` marks.
Axis make_axis(AxisKind kind, std::span<const double> values, int ticks);

/// logarithmic where the positive values span more than a factor of `most_ratio`, else `otherwise`.
AxisKind axis_kind(std::span<const double> values, double most_ratio, AxisKind otherwise);

}  // namespace kerf::report
