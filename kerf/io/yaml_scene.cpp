#include "kerf/io/yaml_scene.h"

#include "kerf/base/error.h"

namespace kerf {

SceneDescription read_yaml_scene(const std::string& path) { throw Error(ErrorCode::file, path, "being written"); }

SceneDescription parse_yaml_scene(const std::string&, const std::string& name, const std::string&) {
  throw Error(ErrorCode::file, name, "being written");
}

}  // namespace kerf
