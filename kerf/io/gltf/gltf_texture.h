#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include "kerf/base/vec3.h"
#include "kerf/io/gltf/gltf_file.h"
#include "kerf/io/material.h"

namespace kerf {

/// Which texture coordinates a texture is looked up with, and what is done to them first.
struct GltfUvs {
  int set = 0;              ///< of TEXCOORD_
  bool is_identity = true;  ///< nothing is done
  bool is_repeated = true;  ///< false where the file wants the texture clamped or mirrored outside [0, 1]
  double u[3] = {1, 0, 0};  ///< the new u is u[0] * u + u[1] * v + u[2]
  double v[3] = {0, 1, 0};
};

/// KHR_texture_transform and the sampler of a texture; `user` names it in errors.
GltfUvs find_gltf_uvs(const GltfFile& file, const tinygltf::TextureInfo& info, std::string_view user);

/// The numbers of an array in an extension; fails where they are not `count` numbers. Empty where there is no such key.
std::vector<double> extension_numbers(const GltfFile& file, const tinygltf::Value& extension, const std::string& key,
                                      size_t count, std::string_view user);
/// Likewise of a single number.
double extension_number(const GltfFile& file, const tinygltf::Value& extension, const std::string& key, double fallback,
                        std::string_view user);
/// The texture that a key of an extension names; index -1 where there is none.
tinygltf::TextureInfo extension_texture(const GltfFile& file, const tinygltf::Value& extension, const std::string& key,
                                        std::string_view user);

/// The images of a file, decoded when they are asked for. One that is missing or no image is left out with a note.
class GltfTextures {
 public:
  explicit GltfTextures(GltfFile& file) : file_(file) {}

  /// The means of a texture's channels.
  struct Means {
    Vec3d encoded{1, 1, 1};  ///< as they stand in the image, over 255
    Vec3d linear{1, 1, 1};   ///< of what these are in linear light
  };

  /// The number in textures() of json.textures[number]; kNoTexture where it is left out.
  uint32_t add(int number, std::string_view user);
  /// 1 where it is left out.
  Means means(int number, std::string_view user);

  std::vector<Texture> take_textures() { return std::move(textures_); }

 private:
  /// The number of the image of a texture; -1 where it has none.
  int find_image(int number, std::string_view user);
  std::optional<Texture> decode(int image);

  GltfFile& file_;
  std::vector<Texture> textures_;
  std::map<int, uint32_t> added_;  // by image
  std::map<int, Means> means_;
};

}  // namespace kerf
