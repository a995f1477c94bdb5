#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace kerf {

/// The two parts of a glTF file.
struct GltfContainer {
  std::string_view json;
  std::optional<std::span<const char>> binary;  ///< the binary chunk of a .glb
};

/// Takes a .glb apart; what does not begin like one is JSON as a whole. Views are into `bytes`. Throws Error (file)
/// with `path` as place: another version, cut short, chunks that overlap the end or are out of order.
GltfContainer open_gltf_container(std::span<const char> bytes, const std::string& path);

}  // namespace kerf
