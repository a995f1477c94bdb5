#include "kerf/io/texture_read.h"

#include "kerf/base/error.h"

namespace kerf {

Texture decode_texture(std::span<const char>, const std::string& name) {
  throw Error(ErrorCode::file, name, "being written");
}

Texture read_texture(const std::string& path) { throw Error(ErrorCode::file, path, "being written"); }

}  // namespace kerf
