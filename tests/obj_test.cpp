// OBJ: vertices, faces and their attributes, and its errors. Materials are in mtl_test.cpp.

#include "kerf/io/obj.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "kerf/base/error.h"
#include "kerf/base/parallel.h"
#include "kerf/geometry/hit.h"

namespace kerf::test {
namespace {

using Corners = std::vector<Mesh::Corners>;
using Notes = std::vector<std::string>;
constexpr Mesh::Corners kNoCorners = {kNone, kNone, kNone};
constexpr float kInfinity = std::numeric_limits<float>::infinity();

Model parse(const std::string& text) {
  // A copy of just this size, so that the address sanitizer sees a read behind it.
  const std::vector<char> bytes(text.begin(), text.end());
  return parse_obj(bytes, "test.obj");
}

std::string error_of(const std::string& text) {
  try {
    parse(text);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::file);
    return error.what();
  }
  return "no error";
}

void expect_error(const std::string& text, int line, const std::string& sentence) {
  EXPECT_EQ(error_of(text), fmt::format("test.obj:{}: {}", line, sentence));
}

const std::string kFour = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 .5\n";
const std::string kMapped = kFour + "vt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\nvn 0 0 -1\n";

TEST(Obj, ReadsVerticesAndCutsPolygonsAsFansFromTheirFirstCorner) {
  const Model model = parse(kFour + "f 1 2 3\nf 4 3 2 1\nf 2 1 2 3 4\n");
  EXPECT_EQ(model.mesh.vertices, (std::vector<Vec3f>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.5F}}));
  EXPECT_EQ(model.mesh.triangles, (Corners{{0, 1, 2}, {3, 2, 1}, {3, 1, 0}, {1, 0, 1}, {1, 1, 2}, {1, 2, 3}}));
  EXPECT_TRUE(model.mesh.normals.empty() && model.mesh.uvs.empty() && model.mesh.materials.empty());
  EXPECT_TRUE(model.materials.empty() && model.notes.empty());
}

TEST(Obj, AFileWithoutFacesHasNoTriangles) {
  EXPECT_TRUE(parse("").mesh.vertices.empty());
  EXPECT_TRUE(parse("# nothing\n\n").mesh.vertices.empty());
  EXPECT_EQ(parse(kFour).mesh.vertices.size(), 4U);
}

TEST(Obj, CornersHaveNormalsAndTextureCoordinatesOfTheirOwn) {
  const Mesh mesh = parse(kMapped + "f 2/1/2 3/2/2 4/3/1\nf 1/3 2/2 3/1\nf 1//2 2//1 3//1\nf 1 2 3\n").mesh;
  EXPECT_EQ(mesh.triangles, (Corners{{1, 2, 3}, {0, 1, 2}, {0, 1, 2}, {0, 1, 2}}));
  EXPECT_EQ(mesh.uv_corners, (Corners{{0, 1, 2}, {2, 1, 0}, kNoCorners, kNoCorners}));
  EXPECT_EQ(mesh.normal_corners, (Corners{{1, 1, 0}, kNoCorners, {1, 0, 0}, kNoCorners}));
  EXPECT_EQ(mesh.normals, (std::vector<Vec3f>{{0, 0, 1}, {0, 0, -1}}));
  EXPECT_EQ(mesh.uvs, (std::vector<std::array<float, 2>>{{0, 0}, {1, 0}, {1, 1}}));
}

TEST(Obj, AttributesWithTheNumbersOfTheirVerticesTakeNoArraysOfTheirOwn) {
  for (const std::string& face :
       std::vector<std::string>{"1/1/1 2/2/2 3/3/3", "-3/-3/-3 -2/-2/-2 -1/-1/-1", "1/01/+1 2/2/2 3/3/3"}) {
    SCOPED_TRACE(face);
    const std::string three = "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\nvn 0 1 0\nvn 1 0 0\n";
    const Mesh mesh = parse(three + "f " + face + "\n").mesh;
    EXPECT_EQ(mesh.triangles, (Corners{{0, 1, 2}}));
    EXPECT_EQ(mesh.uvs.size(), 3U);
    EXPECT_EQ(mesh.normals.size(), 3U);
    EXPECT_TRUE(mesh.uv_corners.empty() && mesh.normal_corners.empty());
  }
  // Not where there are more vertices than attributes: a mesh without such arrays has one for each.
  EXPECT_EQ(parse(kMapped + "f 1/1 2/2 3/3\n").mesh.uv_corners, (Corners{{0, 1, 2}}));
  EXPECT_EQ(parse(kMapped + "f 1//1 2//2 2//2\n").mesh.normal_corners, (Corners{{0, 1, 1}}));
  // The same text, but not the same numbers: four vertices, three texture coordinates.
  EXPECT_EQ(parse(kMapped + "f -3/-3 -2/-2 -1/-1\n").mesh.uv_corners, (Corners{{0, 1, 2}}));
}

TEST(Obj, AttributesThatNoFaceNamesAreLeftOut) {
  const Mesh mesh = parse(kMapped + "f 1 2 3\n").mesh;
  EXPECT_TRUE(mesh.normals.empty() && mesh.uvs.empty() && mesh.normal_corners.empty() && mesh.uv_corners.empty());
  const Mesh with_normals = parse(kMapped + "f 1//1 2//1 3//1\n").mesh;
  EXPECT_TRUE(with_normals.uvs.empty() && with_normals.uv_corners.empty());
  EXPECT_EQ(with_normals.normal_corners, (Corners{{0, 0, 0}}));
}

TEST(Obj, NegativeNumbersCountBackFromWhereTheyStandAndOthersReachAhead) {
  const Mesh mesh = parse("f 1 2 4\nv 0 0 0\nv 1 0 0\nv 2 0 0\nf -3 -2 -1\nv 3 0 0\nf -3 -2 -1\nf -1 1 -2\n").mesh;
  EXPECT_EQ(mesh.triangles, (Corners{{0, 1, 3}, {0, 1, 2}, {1, 2, 3}, {3, 0, 2}}));
}

TEST(Obj, CommentsBlanksLineEndsAndContinuedLinesAreRight) {
  const Corners expected = {{0, 1, 2}, {0, 1, 2}, {0, 2, 3}};
  for (const std::string& text : std::vector<std::string>{
           kFour + "f 1 2 3\nf 1 2 3 4",
           "\xEF\xBB\xBF" + kFour + "f 1 2 3\nf 1 2 3 4\n",
           kFour + "\n  \t\n# f 1 2 3\n \tf  1\t2 3 \nf 1 2 3 4 # a square\n#",
           kFour + "f 1 2 \\\n3\nf 1 \\\n 2\\\n3 4\n",
           kFour + "f 1 2 \\\r\n3\r\nf \\\r\n1 2 3 4\r\n",
           kFour + "\\\n\\\nf 1 2 3\nf 1 2 3 4 \\\n",
           // A comment ends with its line, lest a path in it take the next one along.
           kFour + "# C:\\models\\\nf 1 2 3\nf 1 2 3 4 # D:\\\n",
           kFour + "g a # C:\\\nf 1 2 3\nf 1 2 3 4\n",
           kFour + "g a \\\nb c\nf 1 2 3\nf 1 2 3 4\n",
           kFour + "g a \\\r\nb c\r\nf 1 2 3\r\nf 1 2 3 4\r\n",
       }) {
    SCOPED_TRACE(text);
    const Mesh mesh = parse(text).mesh;
    EXPECT_EQ(mesh.vertices.size(), 4U);
    EXPECT_EQ(mesh.triangles, expected);
  }
  EXPECT_EQ(error_of("v 0 0 0\rv 1 0 0\r"),
            "test.obj:1: lines end with a carriage return alone; line feeds are expected");
  EXPECT_EQ(parse("v 0 0 0\r").mesh.vertices.size(), 1U);
}

TEST(Obj, WeightsColoursAndThirdTextureCoordinatesArePassedOver) {
  const Mesh mesh = parse(
                        "v 1 2 3 1\nv 1 2 3 .5 .5 .5\nv 1 2 3 1 .5 .5 .5\nvt .25\nvt .25 .5\nvt .25 .5 .75\n"
                        "f 1/1 2/2 3/3\n")
                        .mesh;
  EXPECT_EQ(mesh.vertices, (std::vector<Vec3f>{{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}));
  EXPECT_EQ(mesh.uvs, (std::vector<std::array<float, 2>>{{0.25F, 0}, {0.25F, 0.5F}, {0.25F, 0.5F}}));
}

TEST(Obj, NumbersOfEveryFormAreReadAndNotFiniteOnesLeftToTheScene) {
  const Mesh mesh = parse("v 1 .5 -1e-3\nv +1 1. 1E+2\nv nan -inf Infinity\nv 1e99 -1e-99 -0\n").mesh;
  EXPECT_EQ(mesh.vertices[0], (Vec3f{1, 0.5F, -1e-3F}));
  EXPECT_EQ(mesh.vertices[1], (Vec3f{1, 1, 100}));
  EXPECT_TRUE(std::isnan(mesh.vertices[2].x));
  EXPECT_EQ(mesh.vertices[2].y, -kInfinity);
  EXPECT_EQ(mesh.vertices[2].z, kInfinity);
  EXPECT_EQ(mesh.vertices[3], (Vec3f{kInfinity, 0, 0}));
}

TEST(Obj, WhatAMeshCannotHoldIsPassedOverWithANoteWhereItIsSeen) {
  const Model model = parse(
      kFour +
      "o cube\ng a b\ns off\nmg 1 2\nbevel on\nlod 3\nc_interp on\nvp 1 2\ncstype bezier\ndeg 3\nparm u 0 1\nend\n"
      "f 1 2 3\nshadow_obj x.obj\ntrace_obj x.obj\n");
  EXPECT_EQ(model.mesh.triangles.size(), 1U);
  EXPECT_TRUE(model.notes.empty());
  EXPECT_EQ(parse(kFour + "l 1 2\np 1\nl 2 3\n").notes, (Notes{"points and lines (p, l) are not shown"}));
  EXPECT_EQ(parse("curv 0 1 1 2\nsurf 0 1 0 1 1 2 3 4\ncall a.obj\nusemap x\n").notes,
            (Notes{"free-form curves and surfaces are not shown",
                   "texture maps of the old kind (maplib, usemap) are not shown", "call and csh are not carried out"}));
}

TEST(Obj, TrianglesWithNormalsThatPointNowhereAreFlat) {
  const std::string head = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvn 0 0 1\nvn 0 0 -0\nvn 0 nan 1\nvn 0 0 2\n";
  const Model model = parse(head + "f 1//1 2//2 3//4\nf 1//1 2//4 3//4\nf 1//1 2//3 4//1\n");
  EXPECT_EQ(model.mesh.normal_corners, (Corners{kNoCorners, {0, 3, 3}, kNoCorners}));
  EXPECT_EQ(model.notes, (Notes{"2 triangles have a normal that is zero or not finite; they are shown flat"}));
  // With the numbers of the vertices too.
  EXPECT_EQ(parse(head + "f 1//1 2//2 3//3\n").mesh.normal_corners, (Corners{kNoCorners}));
  // Not where no face has them.
  EXPECT_TRUE(parse(head + "f 1//1 2//1 3//1\n").notes.empty());
  const Model mapped = parse("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 inf\nvt 0 0\nf 1/2 2/1 3/2\n");
  EXPECT_EQ(mapped.mesh.uv_corners, (Corners{kNoCorners}));
  EXPECT_EQ(mapped.notes.size(), 1U);
}

TEST(Obj, NormalsOfExtremeLengthsAreMadeUsable) {
  const Mesh mesh =
      parse("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 3e-30 4e-30\nvn 0 -2e30 0\nvn 0 0 7\nf 1//1 2//2 3//3\n").mesh;
  EXPECT_NEAR(mesh.normals[0].y, 0.6F, 1e-6F);
  EXPECT_NEAR(mesh.normals[0].z, 0.8F, 1e-6F);
  EXPECT_EQ(mesh.normals[1], (Vec3f{0, -1, 0}));
  EXPECT_EQ(mesh.normals[2], (Vec3f{0, 0, 7}));
}

TEST(Obj, ErrorsNameTheLineAndWhatWasExpected) {
  expect_error("v 1 2\n", 1, "the line ends where the z of a vertex was expected");
  expect_error("# c\r\n\r\nv 1 2 x3\r\n", 3, "found 'x3' where the z of a vertex was expected");
  expect_error("v 1 2 3,5\n", 1, "found '3,5' where the z of a vertex was expected");
  expect_error("v 1 2 +-3\n", 1, "found '+-3' where the z of a vertex was expected");
  expect_error("v 1 2 3#\n", 1, "found '3#' where the z of a vertex was expected");
  expect_error("v 1 2 \\\n3x\n", 2, "found '3x' where the z of a vertex was expected");
  expect_error("v 1 2 \\\n\nv\n", 2, "the line ends where the z of a vertex was expected");
  expect_error("v 1 2 3 4 5\n", 1, "a vertex has 5 numbers; 3 were expected, and maybe a weight and a colour");
  expect_error("v 1 2 3 4 5 6 7 8\n", 1, "a vertex has 8 numbers; 3 were expected, and maybe a weight and a colour");
  expect_error("vn 0 1\n", 1, "the line ends where the z of a normal was expected");
  expect_error("vn 0 1 0 0\n", 1, "found '0' behind a normal");
  expect_error("vt\n", 1, "the line ends where the u of a texture coordinate was expected");
  expect_error("vt 0 0 0 0\n", 1, "found '0' behind a texture coordinate");
  expect_error("\nmtllib \n", 2, "the line ends where the name of a material library was expected");
}

TEST(Obj, UnknownKeywordsAreErrorsWithTheNearestRightWord) {
  expect_error("v 0 0 0\nusemlt red\n", 2, "unknown keyword 'usemlt'; did you mean 'usemtl'?");
  expect_error("V 0 0 0\n", 1, "unknown keyword 'V'; did you mean 'v'?");
  expect_error("v1 0 0\n", 1, "unknown keyword 'v1'; did you mean 'v'?");
  expect_error("<html>\n", 1, "unknown keyword '<html>'");
  expect_error(std::string("\x7f"
                           "ELF\0",
                           5),
               1, "unknown keyword '\\x7fELF\\x00'");
}

TEST(Obj, FaceErrorsNameTheLineAndTheNumber) {
  const auto refused = [](const std::string& face, const std::string& sentence) {
    expect_error(kMapped + "f " + face + "\n", 10, sentence);
  };
  refused("", "a face has 0 corners; at least 3 were expected");
  refused("1", "a face has 1 corner; at least 3 were expected");
  refused("1 2 # 3", "a face has 2 corners; at least 3 were expected");
  refused("0 1 2", "the vertex 0 of a face is none: they count from 1, or back from -1");
  refused("1 2 5", "a face has the vertex 5, but the file has 4 vertices");
  refused("1 2 -5", "a face has the vertex -5, but 4 stand above it");
  refused("1 2 99999999999999999999999", "a face has the vertex 99999999999999999999999, but the file has 4 vertices");
  refused("1 2 18446744073709551617", "a face has the vertex 18446744073709551617, but the file has 4 vertices");
  refused("1/1 2/2 3/4", "a face has the texture coordinate 4, but the file has 3 texture coordinates");
  refused("1//1 2//2 3//-3", "a face has the normal -3, but 2 stand above it");
  refused("1//1 2//0 3//1", "the normal 0 of a face is none: they count from 1, or back from -1");
  for (const std::string& corner :
       std::vector<std::string>{"x", "1x", "1.5", "1/", "1//", "1/2/", "/1", "1/1/1/1", "--1", "1/x", "1\\"}) {
    refused(corner + " 2 3",
            fmt::format("found '{}' where a corner such as 1, 1/2, 1//3 or 1/2/3 was expected", corner));
  }
  refused("1/1 2 3/3", "this corner has no texture coordinate, but the first of the face has one");
  refused("1 2 3/3", "this corner has a texture coordinate, but the first of the face has none");
  refused("1/1/1 2/2/1 3/3", "this corner has no normal, but the first of the face has one");
  refused("1/1 2/2/1 3/3", "this corner has a normal, but the first of the face has none");
  expect_error("f -1 -2 -3\n" + kFour, 1, "a face has the vertex -1, but 0 stand above it");
  expect_error("v 0 0 0\nf 1 1 2\n", 2, "a face has the vertex 2, but the file has 1 vertex");
  expect_error("v 0 0 0\nf -1 -1 -2\n", 2, "a face has the vertex -2, but 1 stands above it");
}

/// A file of some megabytes, that is of several parts that are read at once, and the mesh that it is.
struct LargeFile {
  explicit LargeFile(uint32_t count) {
    for (uint32_t i = 0; i < count; ++i) {
      const auto x = static_cast<float>(i % 1000), y = static_cast<float>(i) / 8;
      text += fmt::format("v {} {} -1e-2 # C:\\\n", x, y);
      if (i % 3 == 0) text += fmt::format("vn 0 {} \\\n  1\n", i % 7);
      mesh.vertices.push_back({x, y, -1e-2F});
      if (i % 3 == 0) mesh.normals.push_back({0, static_cast<float>(i % 7), 1});
      if (i < 3) continue;
      const uint32_t normal = i / 3;
      if (i % 2 == 0) {
        text += fmt::format("f -1//-1 -2//{} -3//-1 {}//1\n", normal, i - 2);
      } else {
        text += fmt::format("f {0}//{1} {2}//{1} -3//{3} \\\r\n -4//-{4}\n", i + 1, normal + 1, i, normal, normal + 1);
      }
      mesh.triangles.push_back({i, i - 1, i - 2});
      mesh.triangles.push_back({i, i - 2, i - 3});
      const std::array<uint32_t, 4> n =
          i % 2 == 0 ? std::array{normal, normal - 1, normal, 0U} : std::array{normal, normal, normal - 1, 0U};
      mesh.normal_corners.push_back({n[0], n[1], n[2]});
      mesh.normal_corners.push_back({n[0], n[2], n[3]});
    }
  }

  std::string text;
  Mesh mesh;
};

TEST(Obj, FilesOfManyPartsAreTheSameForAnyNumberOfThreads) {
  const LargeFile large(60000);
  ASSERT_GT(large.text.size(), size_t{4} << 20);
  for (const int threads : {1, 4}) {
    with_threads(threads, [&] {
      const Mesh mesh = parse(large.text).mesh;
      EXPECT_TRUE(mesh.vertices == large.mesh.vertices);
      EXPECT_TRUE(mesh.normals == large.mesh.normals);
      EXPECT_TRUE(mesh.triangles == large.mesh.triangles);
      EXPECT_TRUE(mesh.normal_corners == large.mesh.normal_corners);
    });
  }
}

TEST(Obj, OfSeveralErrorsTheFirstInTheFileIsReported) {
  std::string text = LargeFile(60000).text;
  const auto lines_before = [&](size_t at) {
    return 1 + std::count(text.begin(), text.begin() + static_cast<ptrdiff_t>(at), '\n');
  };
  const size_t early = text.find("v ", text.size() / 2), late = text.find("v ", text.size() - 200);
  text[late] = 'w';
  EXPECT_EQ(error_of(text), fmt::format("test.obj:{}: unknown keyword 'w'", lines_before(late)));
  text[early + 2] = 'w';
  for (int i = 0; i < 5; ++i) {
    EXPECT_TRUE(error_of(text).starts_with(fmt::format("test.obj:{}: found 'w", lines_before(early))));
  }
}

TEST(Obj, FilesThatCannotBeReadAreErrorsWithTheirPath) {
  try {
    read_obj("/nowhere/model.obj");
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "/nowhere/model.obj: there is no such file");
  }
}

}  // namespace
}  // namespace kerf::test
