#include "kerf/io/texture_read.h"

#include <fmt/format.h>

#include <cstdlib>
#include <limits>
#include <memory>

#include "kerf/base/error.h"
#include "kerf/base/letter_case.h"
#include "kerf/io/mapped_file.h"
#include "kerf/io/texture/texture_check.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpragmas"
#pragma GCC diagnostic ignored "-Wunknown-warning-option"
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wunused-function"
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC  // other libraries bring a copy of their own
#define STBI_NO_STDIO
// Zeros, so that a damaged image looks the same whenever it is read.
#define STBI_MALLOC(size) std::calloc(1, size)
#define STBI_REALLOC(memory, size) std::realloc(memory, size)
#define STBI_FREE(memory) std::free(memory)
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_ONLY_TGA
#define STBI_ONLY_BMP
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace kerf {
namespace {

bool ends_like_texture(const std::string& path) {
  const std::string name = lower_case(path);
  for (const char* extension : {".png", ".jpg", ".jpeg", ".tga", ".bmp"}) {
    if (name.ends_with(extension)) return true;
  }
  return false;
}

[[noreturn]] void fail_decoding(const std::string& name) {
  const char* const reason = stbi_failure_reason();  // not all failures have one
  throw Error(ErrorCode::file, name, fmt::format("cannot be decoded ({})", reason == nullptr ? "damaged" : reason));
}

}  // namespace

bool is_texture(std::span<const char> bytes, const std::string& name) {
  const TextureFormat format = texture_format(bytes);
  const bool has_signature = format != TextureFormat::unknown && format != TextureFormat::tga;
  return has_signature || ends_like_texture(name);
}

Texture decode_texture(std::span<const char> bytes, const std::string& name) {
  constexpr uint64_t kMostPixels = uint64_t{1} << 28;
  const auto fail = [&](const std::string& sentence) { throw Error(ErrorCode::file, name, sentence); };
  if (bytes.empty()) fail("is not an image: the file is empty");
  if (bytes.size() > std::numeric_limits<int>::max()) fail("has more bytes than are read of an image (2^31)");
  if (const std::string fault = texture_fault(bytes, texture_format(bytes)); !fault.empty()) fail(fault);

  const auto* const data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int size = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  stbi__g_failure_reason = nullptr;  // that of the last image
  if (stbi_info_from_memory(data, size, &width, &height, &channels) == 0) fail_decoding(name);
  if (width <= 0 || height <= 0) fail("has no pixels");
  if (static_cast<uint64_t>(width) * static_cast<uint64_t>(height) > kMostPixels) {
    fail(fmt::format("has {} x {} pixels; at most 2^28 are read", width, height));
  }
  const std::unique_ptr<stbi_uc, void (*)(void*)> rgb(stbi_load_from_memory(data, size, &width, &height, &channels, 3),
                                                      stbi_image_free);
  if (rgb == nullptr) fail_decoding(name);
  Texture texture{static_cast<uint32_t>(width), static_cast<uint32_t>(height), {}};
  texture.rgb.assign(rgb.get(), rgb.get() + size_t{texture.width} * texture.height * 3);
  return texture;
}

Texture read_texture(const std::string& path) {
  const MappedFile file(path);
  return decode_texture(file.bytes(), path);
}

}  // namespace kerf
