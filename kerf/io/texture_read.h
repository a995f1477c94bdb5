#pragma once

#include <span>
#include <string>

#include "kerf/io/material.h"

namespace kerf {

/// Decodes a PNG, JPEG, TGA or BMP image; alpha is dropped, greys become RGB, 16 bits become 8. `name` stands for it in
/// errors. Throws Error (file) for what is no image, is cut short or damaged as far as its format shows, or has more
/// than 2^28 pixels. Memory stays in proportion to the bytes, as far as such images can be packed.
Texture decode_texture(std::span<const char> bytes, const std::string& name);

/// decode_texture() of a file. Throws Error (file) with the path as place.
Texture read_texture(const std::string& path);

/// Whether decode_texture() is meant for it: by its first bytes, or by the end of its name.
bool is_texture(std::span<const char> bytes, const std::string& name);

}  // namespace kerf
