#pragma once

#include <optional>
#include <span>
#include <vector>

namespace kerf {

/// A median with its spread.
struct Spread {
  double median = 0, least = 0, most = 0;
  int count = 0;  ///< values that it is of
};

/// All 0 without values.
Spread spread_of(std::vector<double> values);

/// NaN without values.
double median_of(std::vector<double> values);

/// NaN without values, and where one is not above 0.
double geometric_mean(std::span<const double> values);

struct Interval {
  double lower = 0, upper = 0;
};

/// The ranks, from 1, of the two values between which the median of what was sampled lies with a confidence of at least
/// 95 %, whatever its distribution: the narrowest that are as far from both ends. Of 15 values the 4th and the 12th.
/// Nothing below 6 values, whose least and greatest do not enclose it as surely.
std::optional<int> median_rank(int count);

/// Those two of the values.
std::optional<Interval> median_interval(std::vector<double> values);

}  // namespace kerf
