#include "kerf/study/report/axis.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kerf::report {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kMostMagnitude = 1e300;   // so that no difference overflows
constexpr double kLeastPositive = 1e-300;  // so that no power of ten below it is zero

bool can_hold(AxisKind kind, double value) {
  if (!(std::abs(value) <= kMostMagnitude)) return false;
  return kind == AxisKind::linear || (kind == AxisKind::from_zero && value >= 0) || value >= kLeastPositive;
}

/// The number 1, 2 or 5 times a power of ten that is nearest above.
double nice_step(double least) {
  const double power = std::pow(10, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= least * (1 - 1e-9)) return factor * power;
  }
  return 10 * power;
}

void place_linear(Axis& axis, int ticks) {
  if (axis.kind == AxisKind::from_zero) axis.least = 0;
  if (!(axis.most > axis.least)) {
    const double around = axis.most == 0 ? 1 : std::abs(axis.most) / 2;
    axis.most += around;
    if (axis.kind == AxisKind::linear) axis.least -= around;
  }
  const double step = nice_step(std::max((axis.most - axis.least) / ticks, std::numeric_limits<double>::min()));
  const double first = std::floor(axis.least / step * (1 + 1e-12)), last = std::ceil(axis.most / step * (1 - 1e-12));
  for (double i = first; i <= last && axis.ticks.size() < 64; ++i) axis.ticks.push_back(i * step);
  axis.least = axis.ticks.front();
  axis.most = axis.ticks.back();
}

void place_logarithmic(Axis& axis, int ticks) {
  const auto power = [](double exponent) { return std::pow(10, exponent); };
  if (!(axis.most > axis.least)) {
    axis.least /= 2;
    axis.most *= 2;
  }
  const double first = std::floor(std::log10(axis.least)), last = std::ceil(std::log10(axis.most));
  std::vector<double> marks;
  for (double e = first; e <= last; ++e) {
    for (const double factor : {1.0, 2.0, 5.0}) marks.push_back(factor * power(e));
  }
  const auto begin = std::upper_bound(marks.begin() + 1, marks.end(), axis.least * (1 + 1e-9)) - 1;
  const auto end = std::lower_bound(begin, marks.end() - 1, axis.most * (1 - 1e-9));
  axis.least = *begin;
  axis.most = *end;
  if (last - first <= 3) {
    axis.ticks.assign(begin, end + 1);
  } else {
    const double step = std::ceil((last - first) / ticks);
    for (double e = std::ceil(std::log10(axis.least) - 1e-9); power(e) <= axis.most * (1 + 1e-9); e += step) {
      axis.ticks.push_back(power(e));
    }
  }
}

}  // namespace

bool Axis::holds(double value) const { return can_hold(kind, value); }

double Axis::place(double value) const {
  if (kind != AxisKind::logarithmic) return (value - least) / (most - least);
  return (std::log10(value) - std::log10(least)) / (std::log10(most) - std::log10(least));
}

Axis make_axis(AxisKind kind, std::span<const double> values, int ticks) {
  Axis axis{kind, kInfinity, -kInfinity, {}};
  for (const double value : values) {
    if (!can_hold(kind, value)) continue;
    axis.least = std::min(axis.least, value);
    axis.most = std::max(axis.most, value);
  }
  if (axis.least > axis.most) axis.least = axis.most = 1;  // nothing to show
  if (kind == AxisKind::logarithmic) {
    place_logarithmic(axis, ticks);
  } else {
    place_linear(axis, ticks);
  }
  return axis;
}

AxisKind axis_kind(std::span<const double> values, double most_ratio, AxisKind otherwise) {
  double least = kInfinity, most = 0;
  for (const double value : values) {
    if (!can_hold(AxisKind::logarithmic, value)) continue;
    least = std::min(least, value);
    most = std::max(most, value);
  }
  return least < most && most / least > most_ratio ? AxisKind::logarithmic : otherwise;
}

}  // namespace kerf::report
