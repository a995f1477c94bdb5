#pragma once

#include <cstdint>

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace kerf {

/// While one lives, this thread rounds to nearest and keeps denormals, whatever the caller had set (flush-to-zero is
/// common in audio and games); then the caller's setting returns. Reading costs a few cycles, writing only happens
/// where the setting differs.
class StandardFloat {
 public:
#if defined(__SSE2__)
  StandardFloat() : saved_(_mm_getcsr()) {
    if ((saved_ & kControl) != kStandard) _mm_setcsr((saved_ & ~kControl) | kStandard);
  }
  ~StandardFloat() {
    if ((saved_ & kControl) != kStandard) _mm_setcsr((_mm_getcsr() & ~kControl) | (saved_ & kControl));
  }

 private:
  static constexpr uint32_t kControl = 0xE040;   // flush to zero, rounding mode, denormals are zero
  static constexpr uint32_t kStandard = 0x0000;  // nearest, denormals kept
  uint32_t saved_;
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
