// Small glTFs made by hand, for the tests of the reader.

#pragma once

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "kerf/base/error.h"
#include "kerf/io/gltf.h"
#include "support/folder.h"

namespace kerf::test {

template <class T>
constexpr int component_type() {
  if constexpr (std::is_same_v<T, int8_t>) return 5120;
  if constexpr (std::is_same_v<T, uint8_t>) return 5121;
  if constexpr (std::is_same_v<T, int16_t>) return 5122;
  if constexpr (std::is_same_v<T, uint16_t>) return 5123;
  if constexpr (std::is_same_v<T, uint32_t>) return 5125;
  return 5126;
}

inline std::string base64(std::string_view bytes) {
  constexpr char kAlphabet[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t bits = 0;
    for (size_t k = i; k < i + 3; ++k) bits = bits << 8 | (k < bytes.size() ? static_cast<uint8_t>(bytes[k]) : 0U);
    const size_t digits = std::min<size_t>(bytes.size() - i, 3) + 1;
    for (size_t k = 0; k < 4; ++k) text += k < digits ? kAlphabet[bits >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

inline std::string bytes_of(uint32_t number) { return {reinterpret_cast<const char*>(&number), 4}; }

/// The parts of a glTF, each a list of JSON objects. These tests are for little-endian machines.
struct GltfMaker {
  std::vector<std::string> accessors, views, meshes, nodes, scenes, materials, textures, images, cameras, samplers;
  std::string more;  ///< members of the root, each with a comma in front
  std::string binary;
  std::string version = "2.0";

  /// A view of new bytes of the buffer.
  int view(std::string_view bytes, const std::string& extra = "") {
    binary.resize((binary.size() + 3) / 4 * 4);
    views.push_back("{\"buffer\":0,\"byteOffset\":" + std::to_string(binary.size()) +
                    ",\"byteLength\":" + std::to_string(bytes.size()) + extra + "}");
    binary += bytes;
    return static_cast<int>(views.size()) - 1;
  }

  /// An accessor of `components` numbers each, with a view of its own.
  template <class T>
  int accessor(const std::vector<T>& values, size_t components, const std::string& extra = "") {
    const int number = view({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)});
    return accessor_of<T>(values.size() / components, components, ",\"bufferView\":" + std::to_string(number) + extra);
  }

  template <class T>
  int accessor_of(size_t count, size_t components, const std::string& extra) {
    const char* types[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
    accessors.push_back("{\"componentType\":" + std::to_string(component_type<T>()) + ",\"count\":" +
                        std::to_string(count) + ",\"type\":\"" + types[components - 1] + "\"" + extra + "}");
    return static_cast<int>(accessors.size()) - 1;
  }

  /// A mesh of one primitive. `attributes`: "POSITION":0 and so on; `extra` begins with a comma.
  int mesh(const std::string& attributes, const std::string& extra = "") {
    return add(meshes, "{\"primitives\":[{\"attributes\":{" + attributes + "}" + extra + "}]}");
  }

  static int add(std::vector<std::string>& list, const std::string& object) {
    list.push_back(object);
    return static_cast<int>(list.size()) - 1;
  }

  /// The text; `buffer` is the buffer's uri, or empty for none.
  std::string json(const std::string& uri) const {
    std::string text = "{\"asset\":{\"version\":\"" + version + "\"}";
    const auto list = [&](const char* name, const std::vector<std::string>& objects) {
      if (objects.empty()) return;
      text += std::string(",\"") + name + "\":[";
      for (size_t i = 0; i < objects.size(); ++i) text += (i == 0 ? "" : ",") + objects[i];
      text += "]";
    };
    list("accessors", accessors);
    list("bufferViews", views);
    list("meshes", meshes);
    list("nodes", nodes);
    list("scenes", scenes);
    list("materials", materials);
    list("textures", textures);
    list("images", images);
    list("cameras", cameras);
    list("samplers", samplers);
    if (!binary.empty()) {
      text += ",\"buffers\":[{\"byteLength\":" + std::to_string(binary.size()) +
              (uri.empty() ? "" : ",\"uri\":\"" + uri + "\"") + "}]";
    }
    return text + more + "}";
  }

  std::string embedded() const { return json("data:application/octet-stream;base64," + base64(binary)); }

  std::string glb() const {
    std::string text = json(""), bytes = binary;
    text.resize((text.size() + 3) / 4 * 4, ' ');
    bytes.resize((bytes.size() + 3) / 4 * 4);
    const uint32_t length = static_cast<uint32_t>(12 + 8 + text.size() + (bytes.empty() ? 0 : 8 + bytes.size()));
    std::string glb = "glTF" + bytes_of(2) + bytes_of(length);
    glb += bytes_of(static_cast<uint32_t>(text.size())) + "JSON" + text;
    if (!bytes.empty()) glb += bytes_of(static_cast<uint32_t>(bytes.size())) + std::string("BIN\0", 4) + bytes;
    return glb;
  }
};

/// A triangle with the corners 0, x and y, without indices, in a node.
inline GltfMaker triangle() {
  GltfMaker gltf;
  gltf.mesh("\"POSITION\":" + std::to_string(gltf.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3)));
  gltf.nodes = {R"({"mesh":0})"};
  return gltf;
}

inline Model read(const Folder& folder, const std::string& text) { return read_gltf(folder.write("test.gltf", text)); }

inline Model read(const GltfMaker& gltf) { return read(Folder(), gltf.embedded()); }

/// The sentence of the error, which must have the path as place.
inline std::string refusal(const Folder& folder, const std::string& text) {
  const std::string path = folder.write("test.gltf", text);
  try {
    read_gltf(path);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::file);
    EXPECT_EQ(error.place(), path);
    return std::string(error.what()).substr(path.size() + 2);
  }
  return "no error";
}

inline std::string refusal(const GltfMaker& gltf) { return refusal(Folder(), gltf.embedded()); }

using Triangles = std::vector<Mesh::Corners>;
using Points = std::vector<Vec3f>;

/// All that a mesh promises.
inline void expect_sound(const Mesh& mesh) {
  const auto in_range = [](const Triangles& triangles, size_t count, bool may_lack) {
    for (const Mesh::Corners& triangle : triangles) {
      for (const uint32_t corner : triangle) {
        if (corner >= count && !(may_lack && corner == 0xFFFFFFFFU)) return false;
      }
    }
    return true;
  };
  EXPECT_TRUE(in_range(mesh.triangles, mesh.vertices.size(), false));
  const Triangles& normal_corners = mesh.normal_corners.empty() ? mesh.triangles : mesh.normal_corners;
  const Triangles& uv_corners = mesh.uv_corners.empty() ? mesh.triangles : mesh.uv_corners;
  EXPECT_EQ(normal_corners.size(), mesh.triangles.size());
  EXPECT_EQ(uv_corners.size(), mesh.triangles.size());
  EXPECT_TRUE(mesh.normals.empty() || in_range(normal_corners, mesh.normals.size(), true));
  EXPECT_TRUE(mesh.uvs.empty() || in_range(uv_corners, mesh.uvs.size(), true));
  EXPECT_TRUE(mesh.materials.empty() || mesh.materials.size() == mesh.triangles.size());
}

inline void expect_sound(const Model& model) {
  expect_sound(model.mesh);
  for (const uint32_t material : model.mesh.materials) EXPECT_LT(material, model.materials.size());
  for (const Material& material : model.materials) {
    EXPECT_TRUE(material.albedo_texture == kNoTexture || material.albedo_texture < model.textures.size());
  }
  for (const Texture& texture : model.textures) {
    EXPECT_EQ(texture.rgb.size(), size_t{texture.width} * texture.height * 3);
  }
}

}  // namespace kerf::test
