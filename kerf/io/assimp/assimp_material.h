#pragma once

#include <map>
#include <string>
#include <vector>

#include "kerf/io/material.h"
#include "kerf/io/notes.h"

struct aiMaterial;
struct aiScene;

namespace kerf {

/// A material out of Assimp, and the set of texture coordinates that its texture is looked up with.
struct AssimpMaterial {
  Material material;
  unsigned int uv_set = 0;
};

/// Converts Assimp's materials. Textures stand in the file or beside it; one that is missing or no image is left out
/// with a note.
class AssimpMaterials {
 public:
  /// `path` is of the model.
  AssimpMaterials(const aiScene& scene, std::string path, Notes& notes)
      : scene_(scene), path_(std::move(path)), notes_(notes) {}

  AssimpMaterial convert(const aiMaterial& from);

  std::vector<Texture> take_textures() { return std::move(textures_); }

 private:
  void set_texture(const aiMaterial& from, AssimpMaterial& to);
  void set_type(const aiMaterial& from, Material& material);
  uint32_t find_texture(const std::string& name);
  Texture read(const std::string& name) const;
  std::string find_file(std::string name) const;

  const aiScene& scene_;
  std::string path_;
  Notes& notes_;
  std::vector<Texture> textures_;
  std::map<std::string, uint32_t> found_;  // by name
};

}  // namespace kerf
