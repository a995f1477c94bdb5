#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

#include "kerf/base/mix.h"
#include "kerf/base/parallel.h"

namespace kerf {
namespace detail {

/// Eight chains side by side, a word for each in turn, so that none waits for the product of the one before it. A chain
/// maps a word one to one, so one other word is another number in the end, but for mix() of all.
inline uint64_t hash_words(const std::byte* from, size_t words) {
  constexpr size_t kChains = 8;
  uint64_t chains[kChains] = {1, 2, 3, 4, 5, 6, 7, 8};
  const auto step = [&](size_t first, size_t count) {
    for (size_t i = 0; i < count; ++i) {
      uint64_t word;
      std::memcpy(&word, from + (first + i) * sizeof word, sizeof word);
      chains[i] = (chains[i] ^ word) * 0x9E3779B97F4A7C15U;
      chains[i] ^= chains[i] >> 32;
    }
  };
  const size_t whole = words - words % kChains;
  for (size_t first = 0; first < whole; first += kChains) step(first, kChains);
  step(whole, words - whole);
  uint64_t all = mix(words);
  for (const uint64_t chain : chains) all = mix(all + chain);
  return all;
}

}  // namespace detail

/// A number that is equal for equal values, seeded with another such number. T must have no padding. Parallel, in
/// blocks of a fixed size; the outcome does not depend on the number of threads.
template <class T>
uint64_t hash_values(uint64_t seed, std::span<const T> values) {
  static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % sizeof(uint64_t) == 0);
  constexpr size_t kGrain = std::max<size_t>(1, (size_t{1} << 18) / sizeof(T));
  std::vector<uint64_t> blocks((values.size() + kGrain - 1) / kGrain);
  parallel_for(values.size(), kGrain, [&](size_t begin, size_t end) {
    const std::span<const std::byte> bytes = std::as_bytes(values.subspan(begin, end - begin));
    blocks[begin / kGrain] = detail::hash_words(bytes.data(), bytes.size() / sizeof(uint64_t));
  });
  uint64_t state = mix(seed + values.size());
  for (const uint64_t block : blocks) state = mix(state + block);
  return state;
}

}  // namespace kerf
