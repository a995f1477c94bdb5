#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace kerf {

/// A buffer as the text describes it. Text between quotes is as it stands there; see unescape_json().
struct GltfBuffer {
  std::optional<std::string_view> uri;
  std::optional<uint64_t> byte_length;
};

/// An image as the text describes it.
struct GltfImage {
  std::optional<std::string_view> uri;
  std::optional<uint64_t> buffer_view;
};

/// The text of a glTF, taken apart. Views are into the text that was given.
struct GltfText {
  /// What tinygltf is to read: without buffers and images, which may be much and which it would copy, and without all
  /// that is not read from a glTF, in which it would find fault (a skin need not have inverseBindMatrices).
  std::string json;
  std::vector<GltfBuffer> buffers;
  std::vector<GltfImage> images;
  bool has_animations = false;
};

/// Looks through the JSON of a glTF before tinygltf does, which passes over what has the wrong type, cuts large numbers
/// and recurses as deep as the text nests. Throws Error (file) with `path` as place: no JSON, nested deeper than 100, a
/// version other than 2, and in what is read from it a value of the wrong type or a key that stands twice.
GltfText take_gltf_apart(std::string_view text, const std::string& path);

/// What stands between the quotes of a JSON string, with \n, \u00e4 and the like replaced.
std::string unescape_json(std::string_view text);

}  // namespace kerf
