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
  HostileFloat() : saved_(read()) { write(saved_ | kHostile); }
  ~HostileFloat() { write(saved_); }
  HostileFloat(const HostileFloat&) = delete;
  HostileFloat& operator=(const HostileFloat&) = delete;

  /// Whether the thread is as the constructor left it.
  static bool is_on() { return (read() & kHostile) == kHostile; }

 private:
#if defined(__SSE2__)
  using Control = uint32_t;
  static constexpr Control kHostile = 0xC040;
  static Control read() { return _mm_getcsr(); }
  static void write(Control control) { _mm_setcsr(control); }
#else
  using Control = uint64_t;
  static constexpr Control kHostile = 0x1400000;  // FZ, towards +infinity
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
