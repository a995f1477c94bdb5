// STL, ascii and binary, and its errors.

#include "kerf/io/stl.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

#include "kerf/base/error.h"
#include "kerf/io/vertex_joiner.h"
#include "small_images.h"

namespace kerf::test {
namespace {

using Triangles = std::vector<Mesh::Corners>;

Mesh parse(const std::string& text) {
  const std::vector<char> bytes(text.begin(), text.end());  // so that the address sanitizer sees a read behind it
  return parse_stl(bytes, "test.stl");
}

void expect_error(const std::string& text, const std::string& what) {
  try {
    parse(text);
    FAIL() << text;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::file);
    EXPECT_EQ(error.what(), "test.stl" + what);
  }
}

std::string binary(const std::vector<std::array<Vec3f, 3>>& facets, std::string head = "") {
  head.resize(80, ' ');
  std::string text = head + little(facets.size(), 4);
  const auto add = [&](float value) {
    uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    text += little(bits, 4);
  };
  for (const auto& facet : facets) {
    for (int i = 0; i < 3; ++i) add(9);  // a normal
    for (const Vec3f corner : facet) {
      for (uint32_t axis = 0; axis < 3; ++axis) add(corner[axis]);
    }
    text += "xx";
  }
  return text;
}

const Vec3f kA{0, 0, 0}, kB{1, 0, 0}, kC{1, 1, 0.5F}, kD{0, 1, 0};

void expect_square(const Mesh& mesh) {
  EXPECT_EQ(mesh.vertices, (std::vector<Vec3f>{kA, kB, kC, kD}));
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_TRUE(mesh.normals.empty() && mesh.uvs.empty() && mesh.materials.empty());
}

const std::string kSquare =
    "solid a square\n"
    "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 1 1 .5\n endloop\nendfacet\n"
    "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 1 0.5\n  vertex 0 1 0\n endloop\nendfacet\n"
    "endsolid a square\n";

TEST(Stl, ReadsBinaryWhateverItBeginsWith) {
  for (const char* head : {"", "solid cube", "solid\nfacet normal 0 0 1"}) {
    expect_square(parse(binary({{kA, kB, kC}, {kA, kC, kD}}, head)));
  }
  EXPECT_TRUE(parse(binary({})).triangles.empty());
}

TEST(Stl, ReadsAsciiWithAnyBlanksCaseAndNumberOfSolids) {
  expect_square(parse(kSquare));
  std::string text = "\xEF\xBB\xBF \n" + kSquare;
  for (size_t at = 0; (at = text.find('\n', at)) != text.npos; at += 3) text.replace(at, 1, "\r\n\t");
  expect_square(parse(text));
  const std::string facet =
      "FACET NORMAL -nan -1.#IND 0 Outer Loop vertex 0 0 0 Vertex 1 0 0 vertex 1 1 +5e-1 EndLoop endfacet\n";
  const Mesh mesh =
      parse("Solid\n" + facet + "EndSolid\nSOLID b\nendsolid b\nsolid solid\n" + facet + "endsolid facet");
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {0, 1, 2}}));
  EXPECT_TRUE(parse("solid\nendsolid").triangles.empty());
}

TEST(Stl, EqualVerticesAreJoinedInTheOrderOfTheFile) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), tiny = std::numeric_limits<float>::denorm_min();
  const Mesh mesh = parse(binary({{kC, kB, kA},
                                  {Vec3f{-0.F, 0, -0.F}, Vec3f{tiny, 0, 0}, Vec3f{-tiny, 0, 0}},
                                  {Vec3f{nan, 0, 0}, Vec3f{nan, 0, 0}, kB}}));
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {2, 3, 4}, {5, 5, 1}}));
  ASSERT_EQ(mesh.vertices.size(), 6U);
  EXPECT_FALSE(std::signbit(mesh.vertices[2].x));
  const Mesh first = parse(binary({{Vec3f{-0.F, -0.F, -0.F}, kB, kC}}));
  EXPECT_FALSE(std::signbit(first.vertices[0].x));
}

TEST(Stl, ManyVerticesKeepTheirNumbers) {
  const std::string name = "test";
  VertexJoiner joiner(name);
  constexpr uint32_t kSide = 60;
  for (int round = 0; round < 2; ++round) {
    uint32_t expected = 0;
    for (uint32_t x = 0; x < kSide; ++x) {
      for (uint32_t y = 0; y < kSide; ++y) {
        for (uint32_t z = 0; z < kSide; ++z) {
          const Vec3f vertex{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
          ASSERT_EQ(joiner.number(vertex), expected++);
        }
      }
    }
  }
  EXPECT_EQ(joiner.take().size(), kSide * kSide * kSide);
}

TEST(Stl, BinaryErrorsSayHowManyTrianglesAndBytesThereAre) {
  const std::string whole = binary({{kA, kB, kC}, {kA, kC, kD}});
  const auto expect = [](const std::string& text, const std::string& bytes) {
    expect_error(text, ", byte " + bytes +
                           ": is no STL, or a damaged one: it does not begin with 'solid', and as a binary one it "
                           "states 2 triangles, which take 184 bytes, but the file has " +
                           bytes);
  };
  expect(whole.substr(0, 183), "183");
  expect(whole.substr(0, 84), "84");
  expect(whole + " ", "185");
  // A damaged binary one that begins with the word of ascii.
  const std::string named = binary({{kA, kB, kC}, {kA, kC, kD}}, std::string("solid part\0", 11));
  expect(named.substr(0, 150), "150");
  expect_error(whole.substr(0, 83),
               ", byte 83: is no STL: it does not begin with 'solid', and a binary one has at least 84 bytes");
  expect_error("hello", ", byte 5: is no STL: it does not begin with 'solid', and a binary one has at least 84 bytes");
  expect_error("", ":1: is no STL: the file is empty");
}

TEST(Stl, AsciiErrorsNameTheLineAndTheNearestRightWord) {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string text = kSquare;
    return text.replace(text.find(from), from.size(), to);
  };
  expect_error(with("facet", "facte"), ":2: found 'facte'; did you mean 'facet'?");
  expect_error(with("normal", "norm"), ":2: found 'norm'; did you mean 'normal'?");
  expect_error(with("outer", "inner"), ":3: found 'inner'; expected outer");
  expect_error(with("vertex 1 0 0\n  ", ""), ":6: found 'endloop'; expected vertex");
  expect_error(with("vertex 1 0 0", "vertex 1 0"), ":6: found 'vertex' where a number was expected");
  expect_error(with("vertex 1 0 0", "vertex 1 0 0,5"), ":5: found '0,5' where a number was expected");
  expect_error(with("vertex 1 0 0", "vertex 1 0 1.#INF"), ":5: found '1.#INF' where a number was expected");
  expect_error(with("1\n", "x\n"), ":2: found 'x' where a number was expected");
  expect_error(with(" endloop", " vertex 0 0 0\n endloop"), ":7: found 'vertex'; expected endloop");
  expect_error(with("endfacet\nfacet", "facet"), ":8: found 'facet'; expected endfacet");
  expect_error(kSquare + "facet", ":17: found 'facet'; expected solid");
  expect_error("solid a", ":1: the file is cut short: it ends where 'endsolid' was expected");
  expect_error("solid a\nfacet normal 0 0", ":2: the file is cut short: it ends where a number was expected");
  expect_error("solid a\rfacet", ":1: the file is cut short: it ends where 'endsolid' was expected");
}

TEST(Stl, EveryCutIsAnError) {
  const std::string whole = binary({{kA, kB, kC}, {kA, kC, kD}});
  for (size_t size = 0; size < whole.size(); ++size) EXPECT_THROW(parse(whole.substr(0, size)), Error) << size;
  for (size_t size = 0; size < kSquare.rfind(" a square"); ++size) {
    EXPECT_THROW(parse(kSquare.substr(0, size)), Error) << size;
  }
}

TEST(Stl, FilesAreReadWithTheirPathInErrors) {
  const std::string path = testing::TempDir() + "kerf_stl_test." + std::to_string(::getpid()) + ".stl";
  std::ofstream(path, std::ios::binary) << kSquare;
  expect_square(read_stl(path));
  std::filesystem::remove(path);
  try {
    read_stl(path);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.what(), path + ": there is no such file");
  }
}

}  // namespace
}  // namespace kerf::test
