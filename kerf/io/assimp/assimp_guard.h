#pragma once

#include <span>
#include <string>

namespace kerf {

/// While one of these lives, an assertion of Assimp that fails in this thread throws std::runtime_error. Debian builds
/// it with its assertions on, and a damaged archive would otherwise end the program.
class AssimpAssertions {
 public:
  AssimpAssertions();
  ~AssimpAssertions();
  AssimpAssertions(const AssimpAssertions&) = delete;
  AssimpAssertions& operator=(const AssimpAssertions&) = delete;
};

/// Refuses what Assimp is known to read wrongly and without a word. Throws Error (file) with `path` as place: a STEP
/// file that is no building, and an OFF file that counts more than it has bytes.
void check_for_assimp(std::span<const char> bytes, const std::string& path);

}  // namespace kerf
