#include "kerf/io/gltf/gltf_material.h"

#include <fmt/format.h>

#include <algorithm>

namespace kerf {
namespace {

constexpr const char* kUnlit = "KHR_materials_unlit";
constexpr const char* kTransmission = "KHR_materials_transmission";
constexpr const char* kIor = "KHR_materials_ior";
constexpr const char* kStrength = "KHR_materials_emissive_strength";
constexpr const char* kGlossiness = "KHR_materials_pbrSpecularGlossiness";

/// Null where the material has no such extension.
const tinygltf::Value* find_extension(const tinygltf::Material& from, const char* name) {
  const auto found = from.extensions.find(name);
  return found == from.extensions.end() ? nullptr : &found->second;
}

std::string name_of(size_t number) { return fmt::format("materials[{}]", number); }

tinygltf::TextureInfo base_texture(const GltfFile& file, const tinygltf::Material& from, const std::string& name) {
  const tinygltf::Value* glossiness = find_extension(from, kGlossiness);
  if (glossiness == nullptr) return from.pbrMetallicRoughness.baseColorTexture;
  return extension_texture(file, *glossiness, "diffuseTexture", name);
}

/// Converts one material.
class Converter {
 public:
  Converter(GltfFile& file, GltfTextures& textures, const tinygltf::Material& from, const std::string& name,
            bool is_used)
      : file_(file), textures_(textures), from_(from), name_(name), is_used_(is_used) {}

  Material convert() {
    material_.name = from_.name;
    set_albedo();
    set_emission();
    set_type();
    note_rest();
    return material_;
  }

 private:
  void note(const std::string& sentence) {
    if (is_used_) file_.notes.add(sentence, name_);
  }

  double share(double value) {
    constexpr double kTolerance = 1e-4;
    if (value < -kTolerance || value > 1 + kTolerance) note("a factor outside [0, 1] is clamped");
    return std::clamp(value, 0.0, 1.0);
  }

  GltfTextures::Means means(const tinygltf::TextureInfo& info) {
    if (!is_used_ || info.index < 0) return {};
    return textures_.means(info.index, name_);
  }

  double number(const tinygltf::Value& extension, const char* key, double fallback) const {
    return extension_number(file_, extension, key, fallback, name_);
  }

  void set_albedo() {
    std::vector<double> factor = from_.pbrMetallicRoughness.baseColorFactor;
    if (const tinygltf::Value* glossiness = find_extension(from_, kGlossiness)) {
      factor = extension_numbers(file_, *glossiness, "diffuseFactor", 4, name_);
      note("of KHR_materials_pbrSpecularGlossiness only the diffuse part has an effect");
    }
    factor.resize(4, 1);
    for (uint32_t i = 0; i < 3; ++i) material_.albedo[i] = static_cast<float>(share(factor[i]));
    alpha_ = share(factor[3]);
    const tinygltf::TextureInfo texture = base_texture(file_, from_, name_);
    if (is_used_ && texture.index >= 0) material_.albedo_texture = textures_.add(texture.index, name_);
  }

  void set_emission() {
    double strength = 1;
    if (const tinygltf::Value* extension = find_extension(from_, kStrength)) {
      strength = std::max(number(*extension, "emissiveStrength", 1), 0.0);
    }
    const Vec3d mean = means(from_.emissiveTexture).linear;
    for (uint32_t i = 0; i < 3; ++i) {
      material_.emission[i] = static_cast<float>(std::max(from_.emissiveFactor[i], 0.0) * strength * mean[i]);
    }
    const bool is_light = material_.emission.x > 0 || material_.emission.y > 0 || material_.emission.z > 0;
    if (is_light && from_.emissiveTexture.index >= 0) note("its mean colour stands for a texture of emission");
  }

  void set_type() {
    const tinygltf::Value* transmission = find_extension(from_, kTransmission);
    const double share_of_glass = transmission == nullptr ? 0 : number(*transmission, "transmissionFactor", 0);
    if (find_extension(from_, kUnlit) != nullptr) {
      material_.type = MaterialType::constant;
    } else if (transmission != nullptr && share_of_glass > 0) {
      set_glass(*transmission, share_of_glass);
    } else if (from_.alphaMode == "BLEND" && alpha_ < 1) {
      material_.type = MaterialType::glass;
      material_.refractive_index = 1;
      material_.transmission = static_cast<float>(1 - alpha_);
    } else if (find_extension(from_, kGlossiness) == nullptr) {
      set_metal();
    }
  }

  void set_glass(const tinygltf::Value& transmission, double factor) {
    material_.type = MaterialType::glass;
    const tinygltf::TextureInfo texture = extension_texture(file_, transmission, "transmissionTexture", name_);
    if (texture.index >= 0) note("its mean stands for a texture of transmission");
    material_.transmission = static_cast<float>(share(factor) * means(texture).encoded.x);
    if (const tinygltf::Value* ior = find_extension(from_, kIor)) {
      const double index = number(*ior, "ior", 1.5);
      if (index >= 1) material_.refractive_index = static_cast<float>(index);
      if (index < 1) note("an index of refraction below 1 has no effect");
    }
    if (from_.pbrMetallicRoughness.roughnessFactor > 0) note("rough glass is shown as smooth");
  }

  void set_metal() {
    const tinygltf::PbrMetallicRoughness& pbr = from_.pbrMetallicRoughness;
    double metallic = share(pbr.metallicFactor), roughness = share(pbr.roughnessFactor);
    if (pbr.metallicRoughnessTexture.index >= 0) {
      const GltfTextures::Means mean = means(pbr.metallicRoughnessTexture);
      if (metallic > 0) note("its mean stands for a texture of metal and roughness");
      metallic *= mean.encoded.z;
      roughness *= mean.encoded.y;
    }
    if (!(metallic > 0)) return;
    material_.type = MaterialType::metal;
    material_.metallic = static_cast<float>(metallic);
    material_.roughness = static_cast<float>(roughness);
  }

  void note_rest() {
    if (from_.normalTexture.index >= 0) note("normal maps have no effect");
    if (from_.alphaMode == "MASK") note("holes cut by a mask are shown closed");
    if (from_.alphaMode == "BLEND" && material_.albedo_texture != kNoTexture) {
      note("the transparency of a texture has no effect");
    }
  }

  GltfFile& file_;
  GltfTextures& textures_;
  const tinygltf::Material& from_;
  const std::string& name_;
  const bool is_used_;
  Material material_;
  double alpha_ = 1;
};

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

GltfUvs GltfMaterials::uvs(int number) const {
  if (number < 0) return {};
  const std::string name = name_of(static_cast<size_t>(number));
  return find_gltf_uvs(file_, base_texture(file_, file_.json.materials[static_cast<size_t>(number)], name), name);
}

void GltfMaterials::finish(Model& model) const {
  GltfTextures textures(file_);
  const size_t count = file_.json.materials.size();
  for (size_t i = 0; i < count; ++i) {
    model.materials.push_back(Converter(file_, textures, file_.json.materials[i], name_of(i), is_used_[i]).convert());
  }
  if (is_default_used_ && count > 0) {
    tinygltf::Material standard;
    standard.name = "default";
    standard.emissiveFactor = {0, 0, 0};
    model.materials.push_back(Converter(file_, textures, standard, "the default material", true).convert());
  }
  model.textures = textures.take_textures();
}

}  // namespace kerf
