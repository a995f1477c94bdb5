#pragma once

#include <cstdint>
#include <vector>

namespace kerf {

/// A key to sort by, and whose it is. 16 bytes.
struct KeyedNumber {
  uint64_t key = 0;
  uint32_t number = 0;

  friend bool operator==(const KeyedNumber&, const KeyedNumber&) = default;
};

/// Sorts by key; equal keys stay in the order in which they were. Digit by digit from the lowest, each in parallel over
/// fixed blocks; a digit that all keys have in common costs nothing. Takes as much memory again as the items.
void radix_sort(std::vector<KeyedNumber>& items);

}  // namespace kerf
