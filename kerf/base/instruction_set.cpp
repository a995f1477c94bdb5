#include "kerf/base/instruction_set.h"

#include <cstdlib>
#include <string>

#include "kerf/base/error.h"
#include "kerf/base/letter_case.h"
#include "kerf/base/nearest_word.h"
#include "kerf/base/simd_targets.h"

namespace kerf {
namespace {

constexpr const char* kVariable = "KERF_ISA";

/// As everybody calls it, where Highway calls it otherwise.
struct Name {
  std::string_view highway, usual;
};
constexpr Name kNames[] = {
    {"AVX3_DL", "avx512_dl"}, {"AVX3", "avx512"},   {"AVX2", "avx2"}, {"SSE4", "sse4"},     {"SSSE3", "ssse3"},
    {"SSE2", "sse2"},         {"NEON", "neon"},     {"SVE", "sve"},   {"SVE2", "sve2"},     {"SVE_256", "sve_256"},
    {"SVE2_128", "sve2_128"}, {"EMU128", "scalar"}, {"PPC8", "ppc8"}, {"SCALAR", "scalar"},
};

std::string_view name_of(int64_t target) {
  const std::string_view highway = hwy::TargetName(target);
  for (const Name& name : kNames) {
    if (name.highway == highway) return name.usual;
  }
  return highway;
}

/// Then there is nothing to choose, and nothing of Highway's library is needed.
constexpr bool kIsOnlyOne = (HWY_TARGETS & (HWY_TARGETS - 1)) == 0;

/// Where HWY_EXPORT puts the function of a target; Highway's own choice, which is the whole program's, stays as it is.
size_t place_of(int64_t target) {
  if constexpr (kIsOnlyOne) {
    return 0;  // its table has one function only
  } else {
    hwy::ChosenTarget chosen;
    chosen.Update(target);
    return chosen.GetIndex();
  }
}

std::vector<InstructionSet> all_sets() {
  std::vector<InstructionSet> all;
  if constexpr (!kIsOnlyOne) {
    for (const int64_t target : hwy::SupportedAndGeneratedTargets()) all.push_back({name_of(target), place_of(target)});
  }
  if (all.empty()) all.push_back({name_of(HWY_STATIC_TARGET), place_of(HWY_STATIC_TARGET)});
  return all;
}

}  // namespace

std::vector<std::string_view> instruction_sets() {
  std::vector<std::string_view> names;
  for (const InstructionSet& set : all_sets()) names.push_back(set.name);
  return names;
}

InstructionSet chosen_instruction_set() {
  const std::vector<InstructionSet> all = all_sets();
  const char* value = std::getenv(kVariable);  // NOLINT(concurrency-mt-unsafe): nothing here changes the environment
  const std::string_view wanted = value != nullptr ? value : "";
  if (wanted.empty()) return all.front();
  for (const InstructionSet& set : all) {
    if (equals_ignoring_case(set.name, wanted)) return set;
  }
  throw Error(
      ErrorCode::invalid_option, kVariable,
      "this machine has no instruction set '" + std::string(wanted) + "'" + suggestion(wanted, instruction_sets()));
}

}  // namespace kerf
