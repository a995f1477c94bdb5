#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace kerf {

inline constexpr bool kLittleEndianHost = std::endian::native == std::endian::little;

/// A number out of a file, at any alignment; its bytes are turned around first where `swap` is set.
template <class T>
T load_number(const char* from, bool swap) {
  static_assert(sizeof(T) == 1 || sizeof(T) == 2 || sizeof(T) == 4 || sizeof(T) == 8);
  using Bits = std::conditional_t<
      sizeof(T) == 1, uint8_t,
      std::conditional_t<sizeof(T) == 2, uint16_t, std::conditional_t<sizeof(T) == 4, uint32_t, uint64_t>>>;
  Bits bits;
  std::memcpy(&bits, from, sizeof bits);
  if (swap) {
    if constexpr (sizeof(T) == 2) bits = __builtin_bswap16(bits);
    if constexpr (sizeof(T) == 4) bits = __builtin_bswap32(bits);
    if constexpr (sizeof(T) == 8) bits = __builtin_bswap64(bits);
  }
  return std::bit_cast<T>(bits);
}

}  // namespace kerf
