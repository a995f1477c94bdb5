#pragma once

#include <cstdint>

namespace kerf::test {

// How much of a thing tests of every structure take; less under sanitizers, which are ten times as slow.
#ifdef KERF_SANITIZED
inline constexpr uint32_t kManyCoincident = 5'000, kManyThings = 3'000, kManyDraws = 60;
#else
inline constexpr uint32_t kManyCoincident = 100'000, kManyThings = 20'000, kManyDraws = 300;
#endif

}  // namespace kerf::test
