#pragma once

#include <cstdint>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace kerf {

/// While one lives, this thread rounds to nearest and keeps denormals, whatever the caller had set (flush-to-zero is
/// common in audio and games); then the caller's setting returns.
class StandardFloat {
 public:
#if defined(__SSE2__)
  [[gnu::always_inline]] StandardFloat() : is_other_(!is_standard()) {
    if (is_other_) [[unlikely]]
      set();
  }
  [[gnu::always_inline]] ~StandardFloat() {
    if (is_other_) [[unlikely]]
      _mm_setcsr((_mm_getcsr() & ~kControl) | (saved_ & kControl));
  }

 private:
  static constexpr uint32_t kControl = 0xE040;   // flush to zero, rounding mode, denormals are zero
  static constexpr uint32_t kStandard = 0x0000;  // nearest, denormals kept

  /// By what sums come to: to read the register takes a fifth of what a ray that misses everything takes.
  [[gnu::always_inline]] static bool is_standard() {
    // A denormal number from normal ones and the other way round; half up, and a quarter down.
    __m128 sums = _mm_setr_ps(0x1.8p-126F, 0x1p-127F, 1, 1);
    __asm__("" : "+x"(sums));  // not to be worked out beforehand
    sums = _mm_add_ps(sums, _mm_setr_ps(-0x1p-126F, 0x1p-127F, 0x1.8p-24F, 0x1p-25F));
    const __m128i expected = _mm_castps_si128(_mm_setr_ps(0x1p-127F, 0x1p-126F, 1 + 0x1p-23F, 1));
    return _mm_movemask_epi8(_mm_cmpeq_epi32(_mm_castps_si128(sums), expected)) == 0xFFFF;
  }
  void set() {
    saved_ = _mm_getcsr();
    _mm_setcsr((saved_ & ~kControl) | kStandard);
  }

  bool is_other_;
  uint32_t saved_ = kStandard;
#elif defined(__aarch64__)
  StandardFloat() : saved_(read()) {
    if ((saved_ & kControl) != 0) write(saved_ & ~kControl);
  }
  ~StandardFloat() {
    if ((saved_ & kControl) != 0) write(saved_);
  }

 private:
  static constexpr uint64_t kControl = 0x1C80000;  // FZ, rounding mode, FZ16
  static uint64_t read() {
    uint64_t value;
    __asm__ volatile("mrs %0, fpcr" : "=r"(value) : : "memory");
    return value;
  }
  static void write(uint64_t value) { __asm__ volatile("msr fpcr, %0" : : "r"(value) : "memory"); }
  uint64_t saved_;
#endif

 public:
  StandardFloat(const StandardFloat&) = delete;
  StandardFloat& operator=(const StandardFloat&) = delete;
};

}  // namespace kerf
