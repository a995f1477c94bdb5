// Small images made by hand, for the tests of readers.

#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace kerf::test {

using Rgb = std::array<uint8_t, 3>;

inline std::string little(uint64_t value, int bytes) {
  std::string text;
  for (int i = 0; i < bytes; ++i) text += static_cast<char>(i < 8 ? value >> (8 * i) & 0xFF : 0);
  return text;
}

/// A BMP of 24 bits per pixel; pixels row by row from the top.
inline std::string bmp(uint32_t width, uint32_t height, const std::vector<Rgb>& pixels) {
  const size_t row = (width * 3 + 3) / 4 * 4;
  std::string text = "BM" + little(54 + row * height, 4) + little(0, 4) + little(54, 4);
  text += little(40, 4) + little(width, 4) + little(height, 4) + little(1, 2) + little(24, 2) + little(0, 24);
  for (uint32_t y = height; y-- > 0;) {
    std::string line;
    for (uint32_t x = 0; x < width; ++x) {
      const Rgb& pixel = pixels[y * width + x];
      for (const int channel : {2, 1, 0}) line += static_cast<char>(pixel[static_cast<size_t>(channel)]);
    }
    line.resize(row);
    text += line;
  }
  return text;
}

/// The first bytes of a TGA.
inline std::string tga_header(uint32_t width, uint32_t height, uint32_t type, uint32_t bits, uint32_t flags = 0x20) {
  return little(0, 2) + little(type, 1) + little(0, 9) + little(width, 2) + little(height, 2) + little(bits, 1) +
         little(flags, 1);
}

}  // namespace kerf::test
