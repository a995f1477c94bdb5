#pragma once

#include <cstdint>

namespace kerf {

/// Mixes 64 bits (the finalizer of splitmix64: Steele, Lea, Flood 2014): for hashes, and for choices that look random
/// and are the same on every machine.
constexpr uint64_t mix(uint64_t x) {
  x ^= x >> 30;
  x *= 0xBF58476D1CE4E5B9U;
  x ^= x >> 27;
  x *= 0x94D049BB133111EBU;
  return x ^ (x >> 31);
}

/// A number of a sequence of mixed ones.
constexpr uint64_t mix(uint64_t seed, uint64_t number) { return mix(seed + 0x9E3779B97F4A7C15U * (number + 1)); }

}  // namespace kerf
