#pragma once

#include <string>
#include <string_view>

#include "kerf/io/gltf/gltf_bytes.h"
#include "kerf/io/gltf/gltf_container.h"
#include "kerf/io/notes.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpragmas"
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wshadow"
#include <tiny_gltf.h>
#pragma GCC diagnostic pop

namespace kerf {

/// A glTF whose text has been read; what it refers to is checked when it is used.
struct GltfFile {
  std::string path;
  tinygltf::Model json;  ///< without buffers and images, which `bytes` has
  GltfBytes bytes;
  Notes notes;

  /// Throws Error (file) with the path as place.
  [[noreturn]] void fail(const std::string& sentence) const;

  /// json.ARRAY[number], which `user` names as `name`; fails where there is none.
  template <class T>
  const T& member(const std::vector<T>& array, int64_t number, std::string_view name, std::string_view user) const {
    if (number < 0 || static_cast<uint64_t>(number) >= array.size()) fail_member(number, array.size(), name, user);
    return array[static_cast<size_t>(number)];
  }

  /// The bytes of bufferViews[number].
  std::span<const char> view(int64_t number, std::string_view user);

 private:
  [[noreturn]] void fail_member(int64_t number, size_t count, std::string_view name, std::string_view user) const;
};

/// Parses the text. `container` must stay as long as the file. Throws Error (file) with the path as place: text that is
/// no JSON or no glTF 2.0, or an extension that is required and not known.
GltfFile load_gltf(const GltfContainer& container, const std::string& path);

}  // namespace kerf
