#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>

#include "kerf/base/mix.h"

namespace kerf {

/// A number that is equal for equal values, seeded with another such number. T must have no padding.
template <class T>
uint64_t hash_values(uint64_t seed, std::span<const T> values) {
  static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % sizeof(uint64_t) == 0);
  uint64_t state = mix(seed + values.size());
  for (const T& value : values) {
    uint64_t words[sizeof(T) / sizeof(uint64_t)];
    std::memcpy(words, &value, sizeof(T));
    for (const uint64_t word : words) state = mix(state + 0x9E3779B97F4A7C15U + word);
  }
  return state;
}

}  // namespace kerf
