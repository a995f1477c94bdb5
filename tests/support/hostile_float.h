#pragma once

#include <cstdint>

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace kerf::test {

#if defined(__SSE2__) || defined(__aarch64__)
#define KERF_HOSTILE_FLOAT

/// While one lives, this thread flushes denormals to zero, takes them as zero and rounds up, as a host program may.
class HostileFloat {
 public:
#if defined(__SSE2__)
  using Control = uint32_t;
#else
  using Control = uint64_t;
#endif

  /// Or only one of what kEach has.
  explicit HostileFloat(Control what = kHostile) : saved_(read()) { write(saved_ | what); }
  ~HostileFloat() { write(saved_); }
  HostileFloat(const HostileFloat&) = delete;
  HostileFloat& operator=(const HostileFloat&) = delete;

  /// Whether the thread is as the constructor left it.
  static bool is_on(Control what = kHostile) { return (read() & kAll) == what; }
  static bool is_off() { return (read() & kAll) == 0; }

#if defined(__SSE2__)
  /// Denormals flushed, taken as zero; rounding down, up, towards zero.
  static constexpr Control kEach[] = {0x8000, 0x0040, 0x2000, 0x4000, 0x6000};

 private:
  static constexpr Control kHostile = 0xC040, kAll = 0xE040;
  static Control read() { return _mm_getcsr(); }
  static void write(Control control) { _mm_setcsr(control); }
#else
  /// Denormals flushed and taken as zero; rounding up, down, towards zero.
  static constexpr Control kEach[] = {0x1000000, 0x0400000, 0x0800000, 0x0C00000};

 private:
  static constexpr Control kHostile = 0x1400000, kAll = 0x1C00000;  // FZ, towards +infinity
  static Control read() {
    Control control;
    __asm__ volatile("mrs %0, fpcr" : "=r"(control) : : "memory");
    return control;
  }
  static void write(Control control) { __asm__ volatile("msr fpcr, %0" : : "r"(control) : "memory"); }
#endif
  Control saved_;
};
#endif

}  // namespace kerf::test
