#pragma once

#include <span>
#include <string>

#include "kerf/io/material.h"

namespace kerf {

/// Decodes a PNG, JPEG, TGA or BMP image; alpha is dropped, greys become RGB, 16 bits become 8. `name` stands for it in
/// errors. Throws Error (file) for what is no image, is cut short, or has more than 2^28 pixels.
Texture decode_texture(std::span<const char> bytes, const std::string& name);

/// decode_texture() of a file. Throws Error (file) with the path as place.
Texture read_texture(const std::string& path);

}  // namespace kerf
