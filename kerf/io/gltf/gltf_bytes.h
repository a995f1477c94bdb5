#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kerf/io/gltf/gltf_json.h"
#include "kerf/io/mapped_file.h"

namespace kerf {

/// The buffers and images of a glTF: in its binary chunk, in data: URIs, or in files beside it, which are mapped.
/// Each is opened when it is asked for and kept until the end.
///
/// Every member throws Error (file) with the path of the glTF as place, and a sentence that begins with the name of the
/// buffer or image.
class GltfBytes {
 public:
  GltfBytes(const std::string& path, std::vector<GltfBuffer> buffers, std::vector<GltfImage> images,
            std::optional<std::span<const char>> binary);

  /// The bytes of buffers[number], as many as the file says it has.
  std::span<const char> buffer(size_t number);

  size_t image_count() const { return images_.size(); }
  /// What images[number] is taken from, if it is a view of a buffer.
  std::optional<uint64_t> image_buffer_view(size_t number) const { return images_[number].buffer_view; }
  /// The encoded bytes of an image that has a URI.
  std::span<const char> image(size_t number);

  /// The bytes of all that is open.
  uint64_t open_bytes() const { return open_bytes_; }

 private:
  struct Source {
    std::unique_ptr<MappedFile> file;
    std::vector<char> decoded;
  };

  std::span<const char> open(std::string_view raw_uri, const std::string& name);
  std::span<const char> open_file(const std::string& uri, const std::string& name);
  [[noreturn]] void fail(const std::string& name, const std::string& sentence) const;

  std::string path_;
  std::vector<GltfBuffer> buffers_;
  std::vector<GltfImage> images_;
  std::optional<std::span<const char>> binary_;
  std::vector<std::optional<std::span<const char>>> open_buffers_;
  std::vector<Source> sources_;
  uint64_t open_bytes_ = 0;
};

}  // namespace kerf
