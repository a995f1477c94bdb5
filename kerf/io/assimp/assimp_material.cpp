#include "kerf/io/assimp/assimp_material.h"

#include <assimp/GltfMaterial.h>
#include <assimp/material.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "kerf/base/error.h"
#include "kerf/base/letter_case.h"
#include "kerf/io/message.h"
#include "kerf/io/texture_read.h"

namespace kerf {
namespace {

float share(float value) { return value > 0 ? std::min(value, 1.F) : 0.F; }  // NaN too

Vec3f color_of(const aiColor3D& color) { return {share(color.r), share(color.g), share(color.b)}; }

/// Keeps `value` where the material has no such number.
void get(const aiMaterial& from, const char* key, unsigned int type, unsigned int index, float& value) {
  ai_real found = 0;
  if (aiGetMaterialFloatArray(&from, key, type, index, &found, nullptr) == aiReturn_SUCCESS) value = found;
}

/// Texels that Assimp has decoded.
Texture texture_of_texels(const aiTexture& from) {
  Texture texture{from.mWidth, from.mHeight, {}};
  const size_t count = size_t{from.mWidth} * from.mHeight;
  texture.rgb.reserve(count * 3);
  for (size_t i = 0; i < count; ++i) {
    const aiTexel& texel = from.pcData[i];
    texture.rgb.insert(texture.rgb.end(), {texel.r, texel.g, texel.b});
  }
  return texture;
}

}  // namespace

AssimpMaterial AssimpMaterials::convert(const aiMaterial& from) {
  AssimpMaterial result;
  Material& material = result.material;
  aiString name;
  if (from.Get(AI_MATKEY_NAME, name) == aiReturn_SUCCESS) material.name = name.C_Str();
  aiColor3D color;
  if (from.Get(AI_MATKEY_BASE_COLOR, color) == aiReturn_SUCCESS ||
      from.Get(AI_MATKEY_COLOR_DIFFUSE, color) == aiReturn_SUCCESS) {
    material.albedo = color_of(color);
  }
  if (from.Get(AI_MATKEY_COLOR_EMISSIVE, color) == aiReturn_SUCCESS) {
    float intensity = 1;
    get(from, AI_MATKEY_EMISSIVE_INTENSITY, intensity);
    const auto radiance = [&](float value) { return value * intensity > 0 ? value * intensity : 0.F; };
    material.emission = {radiance(color.r), radiance(color.g), radiance(color.b)};
  }
  set_texture(from, result);
  set_type(from, material);
  return result;
}

void AssimpMaterials::set_texture(const aiMaterial& from, AssimpMaterial& to) {
  for (const aiTextureType type : {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE}) {
    aiString name;
    if (from.Get(AI_MATKEY_TEXTURE(type, 0), name) != aiReturn_SUCCESS || name.length == 0) continue;
    to.material.albedo_texture = find_texture(name.C_Str());
    int set = 0;
    if (from.Get(AI_MATKEY_UVWSRC(type, 0), set) == aiReturn_SUCCESS && set > 0) to.uv_set = static_cast<unsigned>(set);
    return;
  }
}

void AssimpMaterials::set_type(const aiMaterial& from, Material& material) {
  float opacity = 1, index = 1, metallic = 0, roughness = 1;
  get(from, AI_MATKEY_OPACITY, opacity);
  get(from, AI_MATKEY_REFRACTI, index);
  get(from, AI_MATKEY_METALLIC_FACTOR, metallic);
  get(from, AI_MATKEY_ROUGHNESS_FACTOR, roughness);
  if (share(opacity) == 0) {
    // Formats disagree on whether 0 is clear or solid, and hardly any file has what nobody can see.
    notes_.add("what would be invisible, with an opacity of 0, is shown as solid", material.name);
    opacity = 1;
  }
  if (share(opacity) < 1) {
    material.type = MaterialType::glass;
    material.transmission = 1 - share(opacity);
    material.refractive_index = index >= 1 && index < 10 ? index : 1.F;
  } else if (share(metallic) > 0) {
    material.type = MaterialType::metal;
    material.metallic = share(metallic);
    material.roughness = share(roughness);
  }
}

uint32_t AssimpMaterials::find_texture(const std::string& name) {
  const auto [found, is_new] = found_.try_emplace(name, kNoTexture);
  if (!is_new) return found->second;
  try {
    Texture texture = read(name);
    found->second = static_cast<uint32_t>(textures_.size());
    textures_.push_back(std::move(texture));
  } catch (const Error& error) {
    notes_.add(fmt::format("a texture is left out: {}: {}", kerf::quoted(name), sentence_of(error)));
  }
  return found->second;
}

Texture AssimpMaterials::read(const std::string& name) const {
  const aiTexture* embedded = scene_.GetEmbeddedTexture(name.c_str());
  if (embedded == nullptr) return read_texture(find_file(name));
  if (embedded->mHeight > 0) return texture_of_texels(*embedded);
  return decode_texture({reinterpret_cast<const char*>(embedded->pcData), embedded->mWidth}, name);
}

std::string AssimpMaterials::find_file(std::string name) const {
  std::replace(name.begin(), name.end(), '\\', '/');
  if (name.starts_with("//")) name.erase(0, 2);  // Blender's way to say that it is relative
  const std::filesystem::path folder = std::filesystem::absolute(path_).parent_path();
  std::error_code error;
  if (std::filesystem::is_regular_file(folder / name, error)) return (folder / name).string();
  // Many a file names its textures as they lay on the disk of who made it, or in capital letters.
  const std::string wanted = lower_case(std::filesystem::path(name).filename().string());
  std::string found;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string other = entry->path().filename().string();
    if (lower_case(other) == wanted && (found.empty() || other < found)) found = other;
  }
  const std::filesystem::path file = folder / found;
  if (!found.empty() && std::filesystem::is_regular_file(file, error)) return file.string();
  throw Error(ErrorCode::file, name, "there is no such file");
}

}  // namespace kerf
