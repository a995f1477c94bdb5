#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>

namespace kerf {

/// A number that is equal for equal values, seeded with another such number. T must have no padding.
template <class T>
uint64_t hash_values(uint64_t seed, std::span<const T> values) {
  static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % sizeof(uint64_t) == 0);
  // The finalizer of splitmix64 (Steele, Lea, Flood: Fast Splittable Pseudorandom Number Generators, 2014).
  const auto mix = [](uint64_t x) {
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9U;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBU;
    return x ^ (x >> 31);
  };
  uint64_t state = mix(seed + values.size());
  for (const T& value : values) {
    uint64_t words[sizeof(T) / sizeof(uint64_t)];
    std::memcpy(words, &value, sizeof(T));
    for (const uint64_t word : words) state = mix(state + 0x9E3779B97F4A7C15U + word);
  }
  return state;
}

}  // namespace kerf
