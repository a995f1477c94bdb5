#include "kerf/io/obj.h"

#include "kerf/base/error.h"

namespace kerf {

Model read_obj(const std::string& path) { throw Error(ErrorCode::file, path, "being written"); }

}  // namespace kerf
