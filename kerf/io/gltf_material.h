#pragma once

#include <string_view>
#include <vector>

#include "kerf/io/gltf_file.h"
#include "kerf/io/gltf_texture.h"
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
  void finish(Model& model);

 private:
  tinygltf::TextureInfo base_texture(const tinygltf::Material& from, std::string_view user) const;
  Material convert(size_t number);
  void set_type(const tinygltf::Material& from, const std::string& name, double alpha, Material& material);
  void set_metal(const tinygltf::Material& from, const std::string& name, Material& material);
  void set_emission(const tinygltf::Material& from, const std::string& name, Material& material);
  void note_rest(const tinygltf::Material& from, const std::string& name, double alpha);
  /// In [0, 1], with a note where it was not.
  float share(double value, const std::string& name);

  GltfFile& file_;
  std::vector<bool> is_used_;
  bool is_default_used_ = false;
};

}  // namespace kerf
