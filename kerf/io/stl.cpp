#include "kerf/io/stl.h"

#include "kerf/base/error.h"

namespace kerf {

Mesh read_stl(const std::string& path) { throw Error(ErrorCode::file, path, "being written"); }

}  // namespace kerf
