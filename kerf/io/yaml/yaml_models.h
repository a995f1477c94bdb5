#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kerf/base/vec3.h"
#include "kerf/io/model.h"
#include "kerf/io/scene_description.h"
#include "kerf/io/yaml/yaml_node.h"

namespace kerf {

/// The models that a YAML scene places. They are read when the whole text is known to be right, each once.
class YamlModels {
 public:
  /// Files are sought relative to `folder`.
  explicit YamlModels(std::string folder) : folder_(std::move(folder)) {}

  /// Object `object` of the scene, which has an empty mesh so far, becomes the model in `file`, scaled, then moved.
  void place(size_t object, const YamlField& file, Vec3d scale, Vec3d position, bool has_material);

  /// Reads the models and fills the objects in. Where the scene gives no material the model's own ones are appended, or
  /// the default one if it has none. Throws Error (file) with the place of the value of `file`.
  void load(SceneDescription& scene);

 private:
  struct Placement {
    size_t object = 0;
    std::string path;
    std::string place;  // of the value of `file`
    Vec3d scale, position;
    bool has_material = false;
  };
  /// A file that is placed at least once.
  struct Loaded {
    size_t placements_left = 0;
    std::optional<Model> model;
    std::optional<uint32_t> first_material;  // in the scene, where its own ones are used
  };

  static void read(const Placement& placement, Loaded& loaded, SceneDescription& scene);
  uint32_t append_materials(Model& model, SceneDescription& scene);

  std::string folder_;
  std::vector<Placement> placements_;
  std::map<std::string, Loaded> loaded_;  // by path
  std::optional<uint32_t> default_material_;
};

}  // namespace kerf
