#include "kerf/io/gltf.h"

#include "kerf/base/error.h"

namespace kerf {

Model read_gltf(const std::string& path) { throw Error(ErrorCode::file, path, "being written"); }

}  // namespace kerf
