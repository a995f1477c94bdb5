#include "kerf/io/gltf_material.h"

#include <fmt/format.h>

#include <algorithm>

namespace kerf {
namespace {

constexpr const char* kUnlit = "KHR_materials_unlit";
constexpr const char* kTransmission = "KHR_materials_transmission";
constexpr const char* kIor = "KHR_materials_ior";
constexpr const char* kStrength = "KHR_materials_emissive_strength";
constexpr const char* kGlossiness = "KHR_materials_pbrSpecularGlossiness";

const tinygltf::Value* find_extension(const tinygltf::Material& from, const char* name) {
  const auto found = from.extensions.find(name);
  return found == from.extensions.end() ? nullptr : &found->second;
}

std::string name_of(size_t number) { return fmt::format("materials[{}]", number); }

}  // namespace

uint32_t GltfMaterials::use(int number, std::string_view user) {
  if (number < 0) {
    is_default_used_ = true;
    return static_cast<uint32_t>(file_.json.materials.size());
  }
  file_.member(file_.json.materials, number, "materials", user);
  is_used_[static_cast<size_t>(number)] = true;
  return static_cast<uint32_t>(number);
}

tinygltf::TextureInfo GltfMaterials::base_texture(const tinygltf::Material& from, std::string_view user) const {
  const tinygltf::Value* glossiness = find_extension(from, kGlossiness);
  if (glossiness == nullptr) return from.pbrMetallicRoughness.baseColorTexture;
  return extension_texture(file_, *glossiness, "diffuseTexture", user);
}

GltfUvs GltfMaterials::uvs(int number) const {
  if (number < 0) return {};
  const std::string name = name_of(static_cast<size_t>(number));
  return find_gltf_uvs(file_, base_texture(file_.json.materials[static_cast<size_t>(number)], name), name);
}

void GltfMaterials::finish(Model& model) {
  GltfTextures textures(file_);
  textures_ = &textures;
  for (size_t i = 0; i < file_.json.materials.size(); ++i) model.materials.push_back(convert(i));
  textures_ = nullptr;
  model.textures = textures.take_textures();
}

}  // namespace kerf
