// Small YAML scenes for the tests of the reader.

#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>
#include <string>

#include "kerf/base/error.h"
#include "kerf/io/yaml_scene.h"

namespace kerf::test {

inline SceneDescription parse(const std::string& text, const std::string& folder = "") {
  // A copy of just this size, so that the address sanitizer sees a read behind it.
  return parse_yaml_scene(std::string(text.data(), text.size()), "t.yaml", folder);
}

inline std::string error_of(const std::string& text, const std::string& folder = "") {
  try {
    parse(text, folder);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::file) << text;
    return error.what();
  }
  return "no error";
}

/// The text, without its mark '^', is refused where the mark stands, with a sentence that has all these parts.
inline void expect_error(std::string text, std::initializer_list<const char*> parts) {
  const size_t mark = text.find('^');
  ASSERT_NE(mark, std::string::npos) << text;
  text.erase(mark, 1);
  SCOPED_TRACE(text);
  const auto lines = std::count(text.begin(), text.begin() + static_cast<ptrdiff_t>(mark), '\n');
  const size_t line_begin = mark == 0 ? 0 : text.rfind('\n', mark - 1) + 1;
  const std::string place = "t.yaml:" + std::to_string(lines + 1) + ":" + std::to_string(mark - line_begin + 1) + ": ";
  const std::string what = error_of(text);
  EXPECT_TRUE(what.starts_with(place)) << what << "\nis not at " << place;
  for (const char* part : parts) EXPECT_NE(what.find(part), std::string::npos) << what << "\nhas not: " << part;
}

/// Two materials, m and n.
inline const std::string kMaterials =
    "materials:\n"
    "  - name: m\n"
    "  - name: n\n"
    "    type: mirror\n";

/// The scene of one item of geometry in flow style, in line 6; with the mark of expect_error() at the item.
inline std::string with_item(const std::string& item) { return kMaterials + "geometry:\n  - {" + item + "}\n"; }
inline std::string at_item(const std::string& item) { return kMaterials + "geometry:\n  - ^{" + item + "}\n"; }

/// The same of one material, in line 2.
inline std::string with_material(const std::string& item) { return "materials:\n  - {" + item + "}\n"; }
inline std::string at_material(const std::string& item) { return "materials:\n  - ^{" + item + "}\n"; }

/// An ASCII PLY of a triangle and the square next to it; three triangles over five vertices.
inline std::string small_ply() {
  return "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
         "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
         "0 0 0\n1 0 0\n1 1 0\n0 1 0\n0.5 2 1\n4 0 1 2 3\n3 3 2 4\n";
}

}  // namespace kerf::test
