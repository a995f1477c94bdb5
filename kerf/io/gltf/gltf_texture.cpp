#include "kerf/io/gltf/gltf_texture.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "kerf/base/error.h"
#include "kerf/io/texture_read.h"

namespace kerf {
namespace {

std::array<double, 256> linear_of_srgb() {
  std::array<double, 256> table{};
  for (size_t i = 0; i < table.size(); ++i) {
    const double encoded = static_cast<double>(i) / 255;
    table[i] = encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
  }
  return table;
}

GltfTextures::Means means_of(const Texture& texture) {
  std::array<std::array<uint64_t, 256>, 3> count{};
  for (size_t i = 0; i < texture.rgb.size(); ++i) ++count[i % 3][texture.rgb[i]];
  const std::array<double, 256> linear = linear_of_srgb();
  const double pixels = static_cast<double>(texture.rgb.size()) / 3;
  GltfTextures::Means means{{0, 0, 0}, {0, 0, 0}};
  for (uint32_t channel = 0; channel < 3; ++channel) {
    for (size_t value = 0; value < 256; ++value) {
      const double share = static_cast<double>(count[channel][value]) / pixels;
      means.encoded[channel] += share * static_cast<double>(value) / 255;
      means.linear[channel] += share * linear[value];
    }
  }
  return means;
}

bool is_repeated(const GltfFile& file, int texture, std::string_view user) {
  const int sampler = file.member(file.json.textures, texture, "textures", user).sampler;
  if (sampler < 0) return true;
  const tinygltf::Sampler& found =
      file.member(file.json.samplers, sampler, "samplers", fmt::format("textures[{}]", texture));
  return found.wrapS == TINYGLTF_TEXTURE_WRAP_REPEAT && found.wrapT == TINYGLTF_TEXTURE_WRAP_REPEAT;
}

}  // namespace

std::vector<double> extension_numbers(const GltfFile& file, const tinygltf::Value& extension, const std::string& key,
                                      size_t count, std::string_view user) {
  if (!extension.Has(key)) return {};
  const tinygltf::Value& value = extension.Get(key);
  std::vector<double> numbers;
  for (size_t i = 0; i < value.ArrayLen(); ++i) {
    const tinygltf::Value& number = value.Get(static_cast<int>(i));
    if (number.IsNumber()) numbers.push_back(number.GetNumberAsDouble());
  }
  if (numbers.size() != count || value.ArrayLen() != count) {
    file.fail(fmt::format("{}: {} must be an array of {} numbers", user, key, count));
  }
  return numbers;
}

double extension_number(const GltfFile& file, const tinygltf::Value& extension, const std::string& key, double fallback,
                        std::string_view user) {
  if (!extension.Has(key)) return fallback;
  const tinygltf::Value& value = extension.Get(key);
  if (!value.IsNumber()) file.fail(fmt::format("{}: {} must be a number", user, key));
  return value.GetNumberAsDouble();
}

tinygltf::TextureInfo extension_texture(const GltfFile& file, const tinygltf::Value& extension, const std::string& key,
                                        std::string_view user) {
  tinygltf::TextureInfo info;
  if (!extension.Has(key)) return info;
  const tinygltf::Value& value = extension.Get(key);
  if (!value.Has("index") || !value.Get("index").IsInt() || value.Get("index").GetNumberAsInt() < 0) {
    file.fail(fmt::format("{}: {} must be an object with the index of a texture", user, key));
  }
  info.index = value.Get("index").GetNumberAsInt();
  if (value.Has("texCoord") && value.Get("texCoord").IsInt()) info.texCoord = value.Get("texCoord").GetNumberAsInt();
  if (value.Has("extensions")) {
    const tinygltf::Value& extensions = value.Get("extensions");
    for (const std::string& name : extensions.Keys()) info.extensions[name] = extensions.Get(name);
  }
  return info;
}

GltfUvs find_gltf_uvs(const GltfFile& file, const tinygltf::TextureInfo& info, std::string_view user) {
  GltfUvs uvs;
  uvs.set = info.texCoord;
  if (info.index >= 0) uvs.is_repeated = is_repeated(file, info.index, user);
  const auto found = info.extensions.find("KHR_texture_transform");
  if (found == info.extensions.end()) return uvs;
  const tinygltf::Value& transform = found->second;
  const std::string name = fmt::format("{} KHR_texture_transform", user);
  const std::vector<double> offset = extension_numbers(file, transform, "offset", 2, name);
  const std::vector<double> scale = extension_numbers(file, transform, "scale", 2, name);
  const double rotation = extension_number(file, transform, "rotation", 0, name);
  uvs.set = static_cast<int>(std::clamp(extension_number(file, transform, "texCoord", uvs.set, name), 0.0, 1e6));
  // Scaled, then turned, then moved. The text of the extension has the sine's sign the other way round; its own test
  // model and every viewer have it so.
  const double s = std::sin(rotation), c = std::cos(rotation);
  const double su = scale.empty() ? 1 : scale[0], sv = scale.empty() ? 1 : scale[1];
  uvs.u[0] = c * su, uvs.u[1] = s * sv, uvs.u[2] = offset.empty() ? 0 : offset[0];
  uvs.v[0] = -s * su, uvs.v[1] = c * sv, uvs.v[2] = offset.empty() ? 0 : offset[1];
  uvs.is_identity = uvs.u[0] == 1 && uvs.u[1] == 0 && uvs.u[2] == 0 && uvs.v[0] == 0 && uvs.v[1] == 1 && uvs.v[2] == 0;
  return uvs;
}

int GltfTextures::find_image(int number, std::string_view user) {
  const tinygltf::Texture& texture = file_.member(file_.json.textures, number, "textures", user);
  const std::string name = fmt::format("textures[{}]", number);
  if (texture.source < 0) {
    file_.notes.add("a texture in a format that is not known is left out", name);
    return -1;
  }
  if (static_cast<size_t>(texture.source) >= file_.bytes.image_count()) {
    file_.fail(fmt::format("{} names images[{}]; the file has {}", name, texture.source, file_.bytes.image_count()));
  }
  return texture.source;
}

std::optional<Texture> GltfTextures::decode(int image) {
  const auto number = static_cast<size_t>(image);
  const std::string name = fmt::format("images[{}]", image);
  std::span<const char> bytes;
  const std::optional<uint64_t> view = file_.bytes.image_buffer_view(number);
  if (view) bytes = file_.view(static_cast<int64_t>(*view), name);
  try {
    if (!view) bytes = file_.bytes.image(number);
    return decode_texture(bytes, name);
  } catch (const Error& error) {
    const std::string sentence = sentence_of(error);
    file_.notes.add(
        fmt::format("a texture is left out: {}{}", sentence.starts_with(name) ? "" : name + ": ", sentence));
    return {};
  }
}

uint32_t GltfTextures::add(int number, std::string_view user) {
  const int image = find_image(number, user);
  if (image < 0) return kNoTexture;
  const auto [found, is_new] = added_.try_emplace(image, kNoTexture);
  if (is_new) {
    if (std::optional<Texture> texture = decode(image)) {
      found->second = static_cast<uint32_t>(textures_.size());
      textures_.push_back(std::move(*texture));
    }
  }
  return found->second;
}

GltfTextures::Means GltfTextures::means(int number, std::string_view user) {
  const int image = find_image(number, user);
  if (image < 0) return {};
  const auto [found, is_new] = means_.try_emplace(image);
  if (is_new) {
    const auto added = added_.find(image);
    if (added != added_.end()) {
      if (added->second != kNoTexture) found->second = means_of(textures_[added->second]);
    } else if (const std::optional<Texture> texture = decode(image)) {
      found->second = means_of(*texture);
    }
  }
  return found->second;
}

}  // namespace kerf
