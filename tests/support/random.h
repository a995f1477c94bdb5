// Random numbers that are the same with every compiler and standard library.

#pragma once

#include <cmath>
#include <cstdint>

#include "kerf/base/vec3.h"

namespace kerf::test {

/// SplitMix64 (Steele, Lea, Flood 2014).
class Random {
 public:
  explicit Random(uint64_t seed) : state_(seed) {}

  uint64_t bits() {
    uint64_t x = state_ += 0x9E3779B97F4A7C15U;
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9U;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBU;
    return x ^ (x >> 31);
  }
  /// A whole number in [0, count).
  uint32_t below(uint32_t count) { return static_cast<uint32_t>((bits() >> 32) * count >> 32); }
  /// In [0, 1).
  float share() { return std::ldexp(static_cast<float>(bits() >> 40), -24); }
  /// In [-1, 1).
  float unit() { return 2 * share() - 1; }
  float between(float low, float high) { return low + (high - low) * share(); }

  Vec3f vector() {
    const float x = unit(), y = unit(), z = unit();
    return {x, y, z};
  }

 private:
  uint64_t state_;
};

}  // namespace kerf::test
