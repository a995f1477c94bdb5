#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace kerf {

/// The formats of images that are read.
enum class TextureFormat : uint8_t { png, jpeg, bmp, tga, unknown };

/// The format of an image by its first bytes. A TGA has no signature: a header that makes sense is taken for one.
TextureFormat texture_format(std::span<const char> bytes);

/// Walks over the parts of an image without decoding it and says what is wrong with it: the end of a sentence such as
/// "is cut short"; empty where nothing is. The decoder would make black pixels of what is missing.
std::string texture_fault(std::span<const char> bytes, TextureFormat format);

}  // namespace kerf
