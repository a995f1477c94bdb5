#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace kerf {

/// One of the instruction sets that vector kernels are compiled for.
struct InstructionSet {
  std::string_view name;  ///< "avx512", "avx2", "sse4", "ssse3", "neon", "scalar" and such
  size_t place;           ///< of its kernels, see KERF_DISPATCH of kerf/base/simd.h
};

/// The names of those that this machine can run, the best first. What the program has told Highway not to use is not
/// among them.
std::vector<std::string_view> instruction_sets();

/// The one whose kernels are to run: what the environment variable KERF_ISA names, whatever its case, else the best.
/// Throws Error(invalid_option) with the nearest right word if this machine cannot run what it names.
InstructionSet chosen_instruction_set();

}  // namespace kerf
