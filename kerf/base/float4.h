#pragma once

namespace kerf {

/// Four floats in a register, on every processor that has such: a language extension of g++ and clang, because
/// Highway's smallest instruction set is larger than what all x86-64 processors have. For loops that are too short for
/// a choice at run time.
using Float4 [[gnu::vector_size(16)]] = float;

inline Float4 min(Float4 a, Float4 b) { return a < b ? a : b; }
inline Float4 max(Float4 a, Float4 b) { return a > b ? a : b; }

/// At an address that 16 divides, whatever there is beside the first float.
inline Float4 load4(const float* from) {
  using Any [[gnu::may_alias]] = Float4;
  return *reinterpret_cast<const Any*>(__builtin_assume_aligned(from, 16));
}

}  // namespace kerf
