#pragma once

#include <span>
#include <string>

namespace kerf {

/// Refuses what Assimp is known to read wrongly and without a word. Throws Error (file) with `path` as place: a STEP
/// file that is no building, and an OFF file that counts more than it has bytes.
void check_for_assimp(std::span<const char> bytes, const std::string& path);

}  // namespace kerf
