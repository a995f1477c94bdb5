#include "kerf/references/welded_sides.h"

#include <algorithm>
#include <bit>

namespace kerf {

size_t WeldedSides::Hash::operator()(uint64_t bits) const {
  bits = (bits ^ (bits >> 31)) * 0x9E3779B97F4A7C15U;
  return bits ^ (bits >> 29);
}

size_t WeldedSides::Hash::operator()(const std::array<uint32_t, 3>& bits) const {
  return (*this)((*this)(uint64_t{bits[0]} << 32 | bits[1]) + bits[2]);
}

WeldedSides::Numbers WeldedSides::add(const Triangle& triangle) {
  Numbers numbers;
  const Vec3f corners[3] = {triangle.a, triangle.b, triangle.c};
  for (uint32_t i = 0; i < 3; ++i) {
    const auto bits = std::bit_cast<std::array<uint32_t, 3>>(corners[i]);
    numbers.places[i] = places_.try_emplace(bits, static_cast<uint32_t>(places_.size())).first->second;
  }
  for (uint32_t i = 0; i < 3; ++i) {
    const auto [low, high] = std::minmax(numbers.places[i], numbers.places[(i + 1) % 3]);
    const uint64_t ends = uint64_t{low} << 32 | high;
    numbers.sides[i] = sides_.try_emplace(ends, static_cast<uint32_t>(sides_.size())).first->second;
  }
  return numbers;
}

}  // namespace kerf
