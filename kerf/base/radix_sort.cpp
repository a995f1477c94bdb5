#include "kerf/base/radix_sort.h"

#include <array>

#include "kerf/base/parallel.h"

namespace kerf {
namespace {

constexpr uint32_t kDigitBits = 8;
constexpr uint32_t kKeyBits = 64;
constexpr size_t kDigits = size_t{1} << kDigitBits;
constexpr size_t kGrain = 16384;

/// One number for each value of a digit.
using Places = std::array<uint32_t, kDigits>;

size_t digit_of(const KeyedNumber& item, uint32_t shift) { return (item.key >> shift) & (kDigits - 1); }

/// The bits in which some key differs from another.
uint64_t differing_bits(const std::vector<KeyedNumber>& items) {
  std::vector<uint64_t> blocks((items.size() + kGrain - 1) / kGrain);
  parallel_for(items.size(), kGrain, [&](size_t begin, size_t end) {
    uint64_t bits = 0;
    for (size_t i = begin; i < end; ++i) bits |= items[i].key ^ items[0].key;
    blocks[begin / kGrain] = bits;
  });
  uint64_t bits = 0;
  for (const uint64_t block : blocks) bits |= block;
  return bits;
}

/// Where each block's first item with each digit goes.
std::vector<Places> first_places(const std::vector<KeyedNumber>& items, uint32_t shift) {
  std::vector<Places> blocks((items.size() + kGrain - 1) / kGrain);
  parallel_for(items.size(), kGrain, [&](size_t begin, size_t end) {
    Places& count = blocks[begin / kGrain];
    count.fill(0);
    for (size_t i = begin; i < end; ++i) ++count[digit_of(items[i], shift)];
  });
  uint32_t place = 0;
  for (size_t digit = 0; digit < kDigits; ++digit) {
    for (Places& block : blocks) {
      const uint32_t count = block[digit];
      block[digit] = place;
      place += count;
    }
  }
  return blocks;
}

}  // namespace

void radix_sort(std::vector<KeyedNumber>& items) {
  if (items.size() < 2) return;
  const uint64_t bits = differing_bits(items);
  std::vector<KeyedNumber> sorted(bits != 0 ? items.size() : 0);
  for (uint32_t shift = 0; shift < kKeyBits; shift += kDigitBits) {
    if ((bits >> shift & (kDigits - 1)) == 0) continue;
    std::vector<Places> places = first_places(items, shift);
    parallel_for(items.size(), kGrain, [&](size_t begin, size_t end) {
      Places& place = places[begin / kGrain];
      for (size_t i = begin; i < end; ++i) sorted[place[digit_of(items[i], shift)]++] = items[i];
    });
    items.swap(sorted);
  }
}

}  // namespace kerf
