#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace kerf {

/// The scalar types of PLY 1.0, under their newer names.
enum class PlyType : uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

/// Bytes that a value of the type takes in a binary file.
constexpr size_t size_of(PlyType type) {
  constexpr uint8_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<size_t>(type)];
}

/// One value, or a list where it has a count type. Names point into the bytes of the file.
struct PlyProperty {
  std::string_view name;
  PlyType type = PlyType::float32;
  std::optional<PlyType> count_type;
};

/// One table of the file: `count` rows of all its properties.
struct PlyElement {
  std::string_view name;
  uint64_t count = 0;
  std::vector<PlyProperty> properties;
  size_t line = 0;
};

enum class PlyFormat : uint8_t { ascii, binary_little_endian, binary_big_endian };

/// What the header of a PLY file says, and where the body begins.
struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
  size_t size = 0;   ///< bytes up to the body
  size_t lines = 0;  ///< lines up to the body
};

/// Reads the header alone; believes no count. Throws Error (file) with the place "name:LINE".
PlyHeader parse_ply_header(std::span<const char> bytes, const std::string& name);

}  // namespace kerf
