#pragma once

#include <array>
#include <cstdint>

namespace kerf {

/// The random numbers of one path: Owen-scrambled Sobol points by hashing (Burley 2020, "Practical Hash-based Owen
/// Scrambling"). Every dimension, or pair of them, is a sequence of its own over the samples of a pixel, well spread
/// and independent of those of other pixels. What is drawn depends on the seed, the pixel, the sample and how many
/// numbers were drawn before, on nothing else. 12 bytes.
class Sampler {
 public:
  Sampler() = default;
  Sampler(uint32_t seed, uint32_t pixel, uint32_t sample) : key_(mixed(mixed(seed) ^ pixel)), sample_(sample) {}

  /// In [0, 1).
  float next() {
    const uint32_t seed = mixed(key_ + kStride * ++dimension_);
    return to_unit(scrambled(reversed(shuffled(seed)), mixed(seed)));
  }

  /// A point of the unit square.
  std::array<float, 2> next_pair() {
    const uint32_t seed = mixed(key_ + kStride * ++dimension_);
    const uint32_t index = shuffled(seed);
    return {to_unit(scrambled(reversed(index), mixed(seed))), to_unit(scrambled(sobol(index), mixed(~seed)))};
  }

 private:
  static constexpr uint32_t kStride = 0x9E3779B9U;  // of 2^32 the golden section: keys of neighbours are far apart

  /// A permutation of 32 bits of which every output bit depends on every input bit.
  static uint32_t mixed(uint32_t x) {
    x ^= x >> 16;
    x *= 0x7FEB352DU;
    x ^= x >> 15;
    x *= 0x846CA68BU;
    x ^= x >> 16;
    return x;
  }

  static uint32_t reversed(uint32_t x) {
    x = (x >> 1 & 0x55555555U) | (x & 0x55555555U) << 1;
    x = (x >> 2 & 0x33333333U) | (x & 0x33333333U) << 2;
    x = (x >> 4 & 0x0F0F0F0FU) | (x & 0x0F0F0F0FU) << 4;
    return __builtin_bswap32(x);
  }

  /// Owen's scrambling: each bit is turned over or not by a hash of the bits above it. On reversed bits that is a hash
  /// in which low bits affect high ones only, as sums and products with even numbers do.
  static uint32_t scrambled(uint32_t x, uint32_t seed) {
    x = reversed(x) + seed;
    x ^= x * 0x6C50B47CU;
    x ^= x * 0xB82F1E52U;
    x ^= x * 0xC7AFE638U;
    x ^= x * 0x8D22F6E6U;
    return reversed(x);
  }

  /// The sample's place in this dimension's own order, so that dimensions are not correlated.
  uint32_t shuffled(uint32_t seed) const { return scrambled(sample_, seed); }

  /// The second dimension of Sobol's sequence: bit i of the index turns over the bits of row i of Pascal's triangle.
  static uint32_t sobol(uint32_t index) {
    uint32_t result = 0;
    for (uint32_t row = 0x80000000U; index != 0; index >>= 1, row ^= row >> 1) {
      if ((index & 1) != 0) result ^= row;
    }
    return result;
  }

  static float to_unit(uint32_t x) { return static_cast<float>(x >> 8) * 0x1p-24F; }

  uint32_t key_ = 0;
  uint32_t sample_ = 0;
  uint32_t dimension_ = 0;
};

}  // namespace kerf
