#pragma once

#include <optional>

#include "kerf/io/notes.h"
#include "kerf/io/scene_description.h"
#include "kerf/io/yaml/yaml_node.h"

namespace kerf {

/// Reads the sections `camera`, `settings` and `scene` of a YAML scene, each of which may be missing or empty. Throws
/// Error (file).
void read_yaml_settings(const YamlMap& top, SceneDescription& scene, Notes& notes);

}  // namespace kerf
