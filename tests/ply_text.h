// Small PLYs made by hand, for the tests of the reader.

#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "kerf/base/error.h"
#include "kerf/io/ply.h"

namespace kerf::test {

enum class Format { ascii, little, big };
constexpr Format kFormats[] = {Format::ascii, Format::little, Format::big};

/// Writes the same rows as text or as bytes.
class Ply {
 public:
  Ply(Format format, const std::string& elements) : format_(format) {
    const char* names[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    text_ = std::string("ply\nformat ") + names[static_cast<int>(format)] + " 1.0\n" + elements + "end_header\n";
  }
  template <class T, class... More>
  Ply& add(T value, More... more) {
    if (format_ == Format::ascii) {
      text_ += std::to_string(value) + (sizeof...(more) == 0 ? "" : " ");
    } else {
      char bytes[sizeof(T)];
      std::memcpy(bytes, &value, sizeof value);
      if ((format_ == Format::little) != (std::endian::native == std::endian::little))
        std::reverse(bytes, bytes + sizeof bytes);
      text_.append(bytes, sizeof bytes);
    }
    if constexpr (sizeof...(more) > 0) add(more...);
    return *this;
  }
  template <class... T>
  Ply& row(T... values) {
    add(values...);
    if (format_ == Format::ascii) text_ += "\n";
    return *this;
  }
  const std::string& text() const { return text_; }

 private:
  Format format_;
  std::string text_;
};

inline Mesh parse(const std::string& text) {
  // A copy of just this size, so that the address sanitizer sees a read behind it.
  const std::vector<char> bytes(text.begin(), text.end());
  return parse_ply(bytes, "test.ply");
}

inline std::string error_of(const std::string& text) {
  try {
    parse(text);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::file);
    return error.what();
  }
  return "no error";
}

inline void expect_error(const std::string& text, const std::string& place, const std::string& part) {
  const std::string what = error_of(text);
  EXPECT_TRUE(what.starts_with("test.ply" + place + ": ")) << what;
  EXPECT_NE(what.find(part), std::string::npos) << what << "\nhas not: " << part;
}

using Triangle = std::array<uint32_t, 3>;
using Triangles = std::vector<Triangle>;
using U8 = uint8_t;

inline const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";
inline const std::string kList = "property list uchar int vertex_indices\n";

/// Four vertices, a triangle and a quad; 2 of each.
inline Ply square(Format format) {
  Ply ply(format, "element vertex 4\n" + kXyz + "element face 2\n" + kList);
  ply.row(0.F, 0.F, 0.F).row(1.F, 0.F, 0.F).row(1.F, 1.F, 0.F).row(0.F, 1.F, 0.5F);
  return ply.row(U8{3}, 0, 1, 2).row(U8{4}, 0, 1, 2, 3);
}

inline void expect_square(const Mesh& mesh) {
  ASSERT_EQ(mesh.vertices.size(), 4U);
  EXPECT_EQ(mesh.vertices[2], (Vec3f{1, 1, 0}));
  EXPECT_EQ(mesh.vertices[3], (Vec3f{0, 1, 0.5F}));
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {0, 1, 2}, {0, 2, 3}}));
}

}  // namespace kerf::test
