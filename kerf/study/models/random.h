#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "kerf/base/mix.h"
#include "kerf/base/vec3.h"

namespace kerf {

/// Random numbers of the models, the same with every compiler and standard library: SplitMix64 (Steele, Lea, Flood,
/// "Fast splittable pseudorandom number generators", 2014). Every stream of a seed is independent of the others, so a
/// model gives each of its pieces one, whatever the other pieces draw.
class ModelRandom {
 public:
  ModelRandom(uint64_t seed, uint64_t stream) : state_(mix(mix(seed) + stream)) {}

  uint64_t bits() { return mix(state_ += kStride); }

  /// A whole number in [0, count).
  uint32_t below(uint32_t count) { return static_cast<uint32_t>((bits() >> 32) * count >> 32); }
  /// In [0, 1).
  double share() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  double between(double low, double high) { return low + (high - low) * share(); }
  /// Between two positive numbers, each octave alike.
  double between_octaves(double low, double high) { return low * std::exp2(share() * std::log2(high / low)); }

  Vec3d point_between(Vec3d low, Vec3d high) {
    const double x = between(low.x, high.x), y = between(low.y, high.y), z = between(low.z, high.z);
    return {x, y, z};
  }

  /// A unit vector, every direction alike.
  Vec3d direction() {
    const double z = between(-1, 1), angle = between(0, 2 * std::numbers::pi);
    const double across = std::sqrt(1 - z * z);
    return {across * std::cos(angle), across * std::sin(angle), z};
  }

 private:
  static constexpr uint64_t kStride = 0x9E3779B97F4A7C15U;

  uint64_t state_;
};

}  // namespace kerf
