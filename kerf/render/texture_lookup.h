#pragma once

#include <array>

#include "kerf/io/material.h"

namespace kerf {

/// The linear colour of a texture at (u, v), (0, 0) at its lower left, repeated in both directions; bilinear between
/// the centres of pixels.
Vec3f texture_color(const Texture& texture, std::array<float, 2> uv);

}  // namespace kerf
