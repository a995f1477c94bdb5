#pragma once

#include <cstdint>
#include <vector>

namespace kerf {

/// An image of floats: row by row from the top, pixels from the left, the channels of a pixel side by side.
struct Image {
  uint32_t width = 0;
  uint32_t height = 0;
  uint32_t channels = 0;
  std::vector<float> pixels;  ///< width * height * channels
};

}  // namespace kerf
