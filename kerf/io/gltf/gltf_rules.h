#pragma once

#include <cstddef>
#include <string_view>

namespace kerf {

enum class GltfType { array, object, string, boolean, number, index, size };

/// What type a value of a glTF must have; `key` names it by the keys on the way, with [] for a member of an array.
struct GltfRule {
  std::string_view key;
  GltfType type;
};

inline constexpr size_t kGltfRuleCount = 92;

/// The rule for a value; null where there is none, as for all that is not read.
const GltfRule* find_gltf_rule(std::string_view key);

/// The number of a rule for one key, below kGltfRuleCount; that itself for a rule for many.
size_t number_of(const GltfRule& rule);

/// "an integer of at least 0".
std::string_view expectation(GltfType type);

}  // namespace kerf
