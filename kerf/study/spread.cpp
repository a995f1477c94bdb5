#include "kerf/study/spread.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kerf {
namespace {

constexpr double kEachTail = 0.025;

}  // namespace

Spread spread_of(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const size_t n = values.size();
  return {(values[(n - 1) / 2] + values[n / 2]) / 2, values.front(), values.back(), static_cast<int>(n)};
}

double median_of(std::vector<double> values) {
  return values.empty() ? std::numeric_limits<double>::quiet_NaN() : spread_of(std::move(values)).median;
}

double geometric_mean(std::span<const double> values) {
  double sum = 0;
  for (const double value : values) {
    if (!(value > 0)) return std::numeric_limits<double>::quiet_NaN();
    sum += std::log(value);
  }
  return std::exp(sum / static_cast<double>(values.size()));  // NaN for none
}

std::optional<int> median_rank(int count) {
  // How many of the values lie below the median is a throw of as many coins.
  double chance = std::pow(0.5, count), tail = 0;
  int rank = 0;
  for (int below = 0; below < count; ++below) {
    tail += chance;
    if (tail > kEachTail) break;
    rank = below + 1;
    chance *= static_cast<double>(count - below) / (below + 1);
  }
  return rank > 0 ? std::optional(rank) : std::nullopt;
}

std::optional<Interval> median_interval(std::vector<double> values) {
  const std::optional<int> rank = median_rank(static_cast<int>(values.size()));
  if (!rank) return std::nullopt;
  std::sort(values.begin(), values.end());
  return Interval{values[static_cast<size_t>(*rank) - 1], values[values.size() - static_cast<size_t>(*rank)]};
}

}  // namespace kerf
