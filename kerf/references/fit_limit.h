#pragma once

#include <cmath>
#include <cstddef>
#include <optional>

namespace kerf {

/// Lowers `limit`, which fits, towards `too_small`, which does not, as far as `try_limit` says that it fits: to 0.05 %,
/// or until the count that it tells is within 0.1 % of `most`. try_limit(limit) gives the count, or nothing if that
/// would be above `most`. For counts that grow as the limit falls: bisection on a logarithmic scale; the way down in
/// large steps comes first, as little is cut there.
template <class TryLimit>
double lower_to_fit(double limit, double too_small, size_t count, size_t most, TryLimit&& try_limit) {
  constexpr double kStep = 8, kPrecision = 1.0005, kEnough = 0.999;
  bool found_too_small = false;
  while (limit > too_small * kPrecision && static_cast<double>(count) < kEnough * static_cast<double>(most)) {
    found_too_small = found_too_small || limit / kStep <= too_small;
    const double middle = found_too_small ? std::sqrt(limit) * std::sqrt(too_small) : limit / kStep;
    if (!(too_small < middle && middle < limit)) break;
    if (const std::optional<size_t> fitting = try_limit(middle)) {
      limit = middle;
      count = *fitting;
    } else {
      too_small = middle;
      found_too_small = true;
    }
  }
  return limit;
}

}  // namespace kerf
