#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace kerf {

/// The keywords of an OBJ that make geometry or name materials; `other` is known or unknown.
enum class ObjKeyword : uint8_t { vertex, uv, normal, face, material, library, other };

inline ObjKeyword obj_keyword(std::string_view word) {
  if (word == "v") return ObjKeyword::vertex;
  if (word == "f" || word == "fo") return ObjKeyword::face;  // fo: its name in version 2
  if (word == "vt") return ObjKeyword::uv;
  if (word == "vn") return ObjKeyword::normal;
  if (word == "usemtl") return ObjKeyword::material;
  if (word == "mtllib") return ObjKeyword::library;
  return ObjKeyword::other;
}

struct ObjCounts {
  uint64_t vertices = 0, uvs = 0, normals = 0, triangles = 0;
};

/// How the corners of faces name one of their attributes.
struct ObjAttributeUse {
  bool present = false;  ///< some do
  bool missing = false;  ///< some do not
  bool differs = false;  ///< some with another number than that of the vertex, maybe
};

/// A usemtl or mtllib statement.
struct ObjName {
  const char* at;         ///< where the name begins
  std::string_view name;  ///< as it stands in the text; see obj_name()
  uint64_t triangle;      ///< how many stand before it
};

/// A part of an OBJ that begins and ends between statements.
struct ObjChunk {
  const char* begin = nullptr;
  const char* end = nullptr;
  ObjCounts counts;  ///< of what is in it
  ObjCounts before;  ///< of what is in all chunks before it
  ObjAttributeUse uvs, normals;
  std::vector<ObjName> materials, libraries;
};

/// Cuts the text into chunks of nearly one size and counts what is in each, so that all can then be read at once, each
/// into its own place. Believes the text: what is wrong with it is found when it is read.
std::vector<ObjChunk> scan_obj(std::span<const char> text);

/// What is in all chunks together.
ObjCounts total_counts(std::span<const ObjChunk> chunks);

}  // namespace kerf
