#include "kerf/io/assimp_model.h"

#include "kerf/base/error.h"

namespace kerf {

Model read_with_assimp(const std::string& path) { throw Error(ErrorCode::file, path, "being written"); }

std::vector<std::string> assimp_extensions() { return {}; }

}  // namespace kerf
