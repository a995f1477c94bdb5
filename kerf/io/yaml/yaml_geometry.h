#pragma once

#include "kerf/io/notes.h"
#include "kerf/io/scene_description.h"
#include "kerf/io/yaml/yaml_material.h"
#include "kerf/io/yaml/yaml_models.h"
#include "kerf/io/yaml/yaml_node.h"

namespace kerf {

/// Reads the section `geometry` of a YAML scene: appends its objects, of which those that are models stay empty and are
/// noted in `models`. Triangles that follow each other become one mesh. Throws Error (file).
void read_yaml_geometry(const YamlField& section, const YamlMaterials& materials, SceneDescription& scene,
                        YamlModels& models, Notes& notes);

}  // namespace kerf
