#pragma once

#include <bit>
#include <cstdint>
#include <limits>

namespace kerf {

/// The next float towards minus infinity; minus infinity stays. Takes -0 as 0.
constexpr float next_below(float x) {
  if (!(x > -std::numeric_limits<float>::infinity())) return x;
  if (x == 0) return -std::numeric_limits<float>::denorm_min();
  const uint32_t bits = std::bit_cast<uint32_t>(x);
  return std::bit_cast<float>(x > 0 ? bits - 1 : bits + 1);
}

constexpr float next_above(float x) { return -next_below(-x); }

/// The largest float that is at most x; never -0.
constexpr float round_down(double x) {
  const float nearest = static_cast<float>(x) + 0.0F;
  return static_cast<double>(nearest) > x ? next_below(nearest) : nearest;
}

/// The smallest float that is at least x; never -0.
constexpr float round_up(double x) { return 0.0F - round_down(-x); }

/// -0 becomes 0, all else stays: boxes, ties and hashes then see one zero.
constexpr float without_minus_zero(float x) { return x + 0.0F; }

}  // namespace kerf
