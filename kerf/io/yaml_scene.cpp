#include "kerf/io/yaml_scene.h"

#include <filesystem>
#include <string_view>

#include "kerf/io/mapped_file.h"
#include "kerf/io/notes.h"
#include "kerf/io/yaml/yaml_geometry.h"
#include "kerf/io/yaml/yaml_material.h"
#include "kerf/io/yaml/yaml_models.h"
#include "kerf/io/yaml/yaml_node.h"
#include "kerf/io/yaml/yaml_parse.h"
#include "kerf/io/yaml/yaml_settings.h"

namespace kerf {
namespace {

constexpr std::string_view kKeys[] = {"camera", "settings", "scene", "materials", "geometry", "geometries"};

SceneDescription parse(std::string_view text, const std::string& name, const std::string& folder) {
  YamlTree tree = parse_yaml(text, name);
  // An empty file is a scene with nothing but sky.
  YamlTree::Node& root = tree.nodes[tree.root.node];
  if (root.kind == YamlKind::null) root.kind = YamlKind::map;
  const YamlMap top({YamlNode(tree, tree.root), "the scene file"}, kKeys, "the scene file");

  SceneDescription scene;
  Notes notes;
  YamlMaterials materials;
  YamlModels models(folder);
  read_yaml_settings(top, scene, notes);
  if (const auto section = top.find("materials")) materials.read(*section, notes);
  scene.materials = materials.all();
  if (const auto section = top.find_either("geometry", "geometries")) {
    read_yaml_geometry(*section, materials, scene, models, notes);
  }
  scene.notes = notes.sentences();
  models.load(scene);
  return scene;
}

}  // namespace

SceneDescription read_yaml_scene(const std::string& path) {
  const MappedFile file(path);
  return parse({file.bytes().data(), file.bytes().size()}, path, std::filesystem::path(path).parent_path().string());
}

SceneDescription parse_yaml_scene(const std::string& text, const std::string& name, const std::string& folder) {
  return parse(text, name, folder);
}

}  // namespace kerf
