#pragma once

#include <string_view>
#include <vector>

#include "kerf/io/gltf/gltf_file.h"
#include "kerf/io/gltf/gltf_texture.h"
#include "kerf/io/model.h"

namespace kerf {

/// The materials of a file. All are converted, so that they keep their numbers, but only those that are used have
/// their images decoded and notes taken.
class GltfMaterials {
 public:
  explicit GltfMaterials(GltfFile& file) : file_(file), is_used_(file.json.materials.size()) {}

  /// Marks json.materials[number] as used and returns its number in the model; that of glTF's default material where
  /// `number` is -1.
  uint32_t use(int number, std::string_view user);

  /// How the base colour of a material is looked up.
  GltfUvs uvs(int number) const;

  /// Puts materials and textures into the model, whose materials stay empty where the file has none.
  void finish(Model& model) const;

 private:
  GltfFile& file_;
  std::vector<bool> is_used_;
  bool is_default_used_ = false;
};

}  // namespace kerf
