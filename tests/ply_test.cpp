// PLY in all its forms, and its errors.

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <thread>

#include "kerf/base/nearest_word.h"
#include "ply_text.h"

namespace kerf::test {
namespace {

TEST(Ply, ReadsAllThreeFormatsAndCutsPolygonsAsFans) {
  for (const Format format : kFormats) expect_square(parse(square(format).text()));
}

template <class T>
void expect_scalar_type(const std::string& name) {
  for (const Format format : kFormats) {
    SCOPED_TRACE(name);
    const auto type = " " + name + " ";
    Ply ply(format, "element vertex 3\nproperty" + type + "x\nproperty" + type + "y\nproperty" + type +
                        "z\nelement face 1\nproperty list" + type + type + "vertex_index\n");
    const T largest = sizeof(T) < 8 ? std::numeric_limits<T>::max() : static_cast<T>(1e9);
    ply.row(T{1}, T{2}, T{3}).row(T{100}, T{101}, T{102}).row(largest, T{0}, T{7});
    const Mesh mesh = parse(ply.row(T{3}, T{2}, T{0}, T{1}).text());
    EXPECT_EQ(mesh.vertices[1], (Vec3f{100, 101, 102}));
    EXPECT_EQ(mesh.vertices[2].x, static_cast<float>(largest));
    EXPECT_EQ(mesh.triangles, (Triangles{{2, 0, 1}}));
  }
}

TEST(Ply, KnowsEveryTypeByBothNamesForCoordinatesCountsAndIndices) {
  for (const char* name : {"char", "int8"}) expect_scalar_type<int8_t>(name);
  for (const char* name : {"uchar", "uint8"}) expect_scalar_type<uint8_t>(name);
  for (const char* name : {"short", "int16"}) expect_scalar_type<int16_t>(name);
  for (const char* name : {"ushort", "uint16"}) expect_scalar_type<uint16_t>(name);
  for (const char* name : {"int", "int32"}) expect_scalar_type<int32_t>(name);
  for (const char* name : {"uint", "uint32"}) expect_scalar_type<uint32_t>(name);
  for (const char* name : {"float", "float32"}) expect_scalar_type<float>(name);
  for (const char* name : {"double", "float64"}) expect_scalar_type<double>(name);
}

TEST(Ply, PassesOverOtherElementsAndPropertiesInAnyOrder) {
  for (const Format format : kFormats) {
    Ply ply(format,
            "comment made by hand\nobj_info any thing 1 2 3\nelement note 2\nproperty list ushort double d\nproperty "
            "char c\n"
            "element empty 18446744073709551615\nelement face 3\nproperty short flags\n" +
                kList +
                "property double weight\n"
                "element camera 2\nproperty float f\nelement vertex 3\nproperty double z\nproperty list uchar short l\n"
                "property uchar red\nproperty float x\nproperty int y\nelement tail 1\nproperty float f\n");
    ply.row(uint16_t{2}, 0.5, 0.25, int8_t{1}).row(uint16_t{0}, int8_t{2});
    ply.row(int16_t{-1}, U8{3}, 0, 1, 2, 1.5)
        .row(int16_t{-1}, U8{3}, 2, 1, 0, 1.5)
        .row(int16_t{-1}, U8{4}, 0, 1, 2, 0, 1.5);
    ply.row(1.F).row(2.F).row(3.0, U8{1}, int16_t{9}, U8{255}, 1.F, 2).row(6.0, U8{0}, U8{255}, 4.F, 5);
    const Mesh mesh = parse(ply.row(9.0, U8{2}, int16_t{9}, int16_t{9}, U8{0}, 7.F, 8).row(0.F).text() + "trailing");
    EXPECT_EQ(mesh.vertices, (std::vector<Vec3f>{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}));
    EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {2, 1, 0}, {0, 1, 2}, {0, 2, 0}}));
  }
}

TEST(Ply, ExtraScalarPropertiesKeepTheFastPathsRight) {
  for (const Format format : {Format::little, Format::big}) {
    Ply ply(format,
            "element vertex 3\nproperty uchar a\nproperty float y\nproperty double b\nproperty float x\n"
            "property float z\nelement face 2\nproperty uchar a\n" +
                kList + "property short b\n");
    for (int i = 0; i < 3; ++i) ply.row(U8{7}, 1.F, 0.5, static_cast<float>(i), 2.F);
    const Mesh mesh = parse(ply.row(U8{1}, U8{3}, 0, 1, 2, int16_t{3}).row(U8{1}, U8{3}, 1, 2, 0, int16_t{3}).text());
    EXPECT_EQ(mesh.vertices[2], (Vec3f{2, 1, 2}));
    EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {1, 2, 0}}));
  }
}

std::string byte_before_end(const std::string& text, size_t bytes) {
  return ", byte " + std::to_string(text.size() - bytes);
}

TEST(Ply, StripsKeepTheirWindingAndRestart) {
  for (const Format format : kFormats) {
    Ply ply(format, "element vertex 5\n" + kXyz + "element tristrips 2\nproperty list int int vertex_indices\n");
    for (int i = 0; i < 5; ++i) ply.row(0.F, 0.F, 0.F);
    const Mesh mesh = parse(ply.row(9, 0, 1, 2, 3, 4, -1, 2, 3, 4).row(3, 0, 1, -1).text());
    EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {2, 1, 3}, {2, 3, 4}, {2, 3, 4}}));
    const std::string wrong =
        Ply(format, "element vertex 0\n" + kXyz + "element tristrips 1\n" + kList).row(U8{1}, -2).text();
    const std::string place = format == Format::ascii ? ":10" : byte_before_end(wrong, 4);
    expect_error(wrong, place, "tristrips 0 has the index -2");
  }
}

TEST(Ply, FilesWithoutFacesHaveNoTriangles) {
  for (const Format format : kFormats) {
    EXPECT_EQ(parse(Ply(format, "element vertex 1\n" + kXyz).row(1.F, 2.F, 3.F).text()).vertices.size(), 1U);
    EXPECT_TRUE(parse(Ply(format, "element vertex 0\n" + kXyz + "element face 0\n").text()).triangles.empty());
  }
}

/// The text with CR LF for its first `lines` line ends.
std::string with_carriage_returns(const std::string& text, size_t lines) {
  std::string result;
  for (const char c : text) {
    if (c == '\n' && lines > 0) {
      result += '\r';
      --lines;
    }
    result += c;
  }
  return result;
}

TEST(Ply, CarriageReturnsBlankLinesAndTabsAreRight) {
  std::string text = with_carriage_returns(square(Format::ascii).text(), 100);
  expect_square(parse(text));
  text += "\r\n  \t\n";
  text.replace(text.rfind(" 1 2"), 1, "\t +");
  expect_square(parse(text));
  for (const Format format : {Format::little, Format::big}) {
    expect_square(parse(with_carriage_returns(square(format).text(), 9)));
  }
}

TEST(Ply, NumbersBeyondARangeAndNotFiniteOnesAreLeftToTheScene) {
  const std::string head = Ply(Format::ascii, "element vertex 1\n" + kXyz).text();
  const Vec3f big = parse(head + "1e999 -1e39 1e-999\n").vertices[0];
  EXPECT_EQ(big, (Vec3f{INFINITY, -INFINITY, 0}));
  const Vec3f odd = parse(head + "nan -inf 1e-40\n").vertices[0];
  EXPECT_TRUE(std::isnan(odd.x) && odd.y == -INFINITY && odd.z == 1e-40F);
  for (const Format format : {Format::little, Format::big}) {
    EXPECT_TRUE(
        std::isnan(parse(Ply(format, "element vertex 1\n" + kXyz).row(NAN, 1.F, INFINITY).text()).vertices[0].x));
    const Ply wide(format, "element vertex 1\nproperty double x\nproperty double y\nproperty double z\n");
    EXPECT_EQ(parse(Ply(wide).row(1e300, 0.0, -1e300).text()).vertices[0], (Vec3f{INFINITY, 0, -INFINITY}));
  }
}

TEST(Ply, HeaderErrorsNameTheLineAndTheNearestWord) {
  const std::string start = "ply\nformat ascii 1.0\n";
  expect_error("", ":1", "the file is empty");
  expect_error("solid cube\n", ":1", "found 'solid cube' where the first line must be 'ply'");
  expect_error("\x1f\x8b\x08", ":1", "found '\\x1f\\x8b\\x08'");
  expect_error("ply\rformat ascii 1.0\r", ":1", "carriage return");
  expect_error("ply\nelement vertex 0\n" + kXyz + "end_header\n", ":6", "no format line");
  expect_error("ply\nformat asci 1.0\n", ":2", "unknown format 'asci'; did you mean 'ascii'?");
  expect_error("ply\nformat binary 1.0\n", ":2", "expected ascii, binary_little_endian or binary_big_endian");
  expect_error("ply\nformat ascii 2.0\n", ":2", "unknown version '2.0'");
  expect_error(start + "format ascii 1.0\n", ":3", "a second format line");
  expect_error(start + "elemnt vertex 1\n", ":3", "unknown word 'elemnt' in the header; did you mean 'element'?");
  expect_error(start + "element vertex -1\n", ":3", "has the count '-1'");
  expect_error(start + "element vertex 99999999999999999999\n", ":3", "has the count '99999999999999999999'");
  expect_error(start + "element vertex\n", ":3", "expected 'element NAME COUNT'");
  expect_error(start + "property float x\n", ":3", "before the first element");
  expect_error(start + "element vertex 1\nproperty flaot x\n", ":4", "unknown type 'flaot'; did you mean 'float'?");
  expect_error(start + "element vertex 1\nproperty vec3f x\n", ":4", "float32, double or float64");
  for (const char* type : {"int64", "uint64"}) {
    expect_error(start + "element vertex 1\nproperty " + type + " x\n", ":4", "not part of PLY 1.0");
  }
  expect_error(start + "element vertex 1\nproperty list uchar x\n", ":4", "expected 'property TYPE NAME'");
  expect_error(start + "element a 1\nelement a 1\n", ":4", "a second element 'a'");
  expect_error(start + "element a 1\nproperty int b\nproperty int b\n", ":5", "a second property 'b' in element a");
  expect_error(start + "element vertex 1\n" + kXyz, ":6", "no line end_header");
}

TEST(Ply, HeadersThatMakeNoMeshAreRefused) {
  const auto with = [](const std::string& elements) { return Ply(Format::ascii, elements).text(); };
  expect_error(with("element edge 0\n"), ":4", "no element vertex");
  expect_error(with("element vertices 0\n" + kXyz), ":3", "unknown element 'vertices'; did you mean 'vertex'?");
  expect_error(with("element vertex 0\n" + kXyz + "element faces 1\n" + kList), ":7", "did you mean 'face'?");
  expect_error(with("element vertex 0\nproperty float x\nproperty float y\nproperty float Z\n"), ":3",
               "no property z, only 'Z'");
  expect_error(with("element vertex 0\nproperty float x\nproperty list int int y\n"), ":3",
               "y of element vertex is a list");
  expect_error(with("element vertex 0\n" + kXyz + "element face 1\nproperty int i\n"), ":7",
               "no property vertex_indices");
  expect_error(with("element vertex 0\n" + kXyz + "element face 1\nproperty int vertex_index\n"), ":7",
               "expected a list");
  expect_error(
      with("element vertex 0\n" + kXyz + "element face 1\n" + kList + "property list uchar int vertex_index\n"), ":7",
      "both");
}

TEST(Ply, BodyErrorsNameThePlaceAndTheRow) {
  const std::string head = Ply(Format::ascii, "element vertex 2\n" + kXyz + "element face 1\n" + kList).text();
  const std::string vertices = "0 0 0\n\n1 1 1\n";  // lines 10 and 12
  expect_error(head + "0 0 0\n1 1 one\n3 0 1 0\n", ":11", "vertex 1 has 'one' where a number was expected (z)");
  expect_error(head + "0 0 0\n1 1 1.5x\n3 0 1 0\n", ":11", "has '1.5x'");
  expect_error(head + "0 0\n1 1 1\n3 0 1 0\n", ":10",
               "vertex 0 has too few values: its line ends where z was expected");
  expect_error(head + "0 0 0 4\n1 1 1\n3 0 1 0\n", ":10", "has more values on its line than the header says, from '4'");
  expect_error(head + vertices + "3 0 1 2\n", ":13",
               "face 0 has the index 2 in vertex_indices, but the file has 2 vertices");
  expect_error(head + vertices + "3 0 1 -1\n", ":13", "face 0 has the index -1");
  expect_error(head + vertices + "3 0 1 1.5\n", ":13", "'1.5' where a whole number was expected");
  expect_error(head + vertices + "3 0 1 99999999999999999999\n", ":13", "out of range");
  expect_error(head + vertices + "2 0 1\n", ":13", "face 0 has 2 corners");
  expect_error(head + vertices + "1 0\n", ":13", "face 0 has 1 corner;");
  expect_error(head + vertices + "-3 0 1 0\n", ":13", "a list vertex_indices of -3 values");
  expect_error(head + vertices + "4000000000 0 1 0\n", ":13", "face 0 has too few values");
  expect_error(head + "0 0 0\n       \n", ":12", "the header says 2 rows of element vertex, 1 is there");
  expect_error(head, ":10", "the header says 2 rows of element vertex, at most 0 are there");
  for (const Format format : {Format::little, Format::big}) {
    const Ply start = Ply(format, "element vertex 3\n" + kXyz + "element face 2\n" + kList)
                          .row(0.F, 0.F, 0.F)
                          .row(1.F, 0.F, 0.F)
                          .row(0.F, 1.F, 0.F)
                          .row(U8{3}, 0, 1, 2);
    const size_t row = start.text().size();
    const auto at = [&](size_t offset) { return ", byte " + std::to_string(row + offset); };
    expect_error(Ply(start).row(U8{3}, 0, 1, 3).text(), at(9), "face 1 has the index 3");
    expect_error(Ply(start).row(U8{3}, 0, -1, 1).text(), at(5), "face 1 has the index -1");
    expect_error(Ply(start).row(U8{2}, 0, 1).text(), at(0), "face 1 has 2 corners");
    expect_error(Ply(start).row(U8{200}, 0, 1).text(), at(0),
                 "of 200 values, but the file ends after 2 more; 1 of 2 rows");
    expect_error(start.text(), at(0), "the header says 2 rows of element face, 1 is there");
    expect_error(start.text().substr(0, row - 20), at(-20), "the header says 3 rows of element vertex, 2 are there");
    const auto one_face = [&](const std::string& types) {
      return Ply(format, "element vertex 2\n" + kXyz + "element face 1\nproperty list " + types + " vertex_index\n")
          .row(0.F, 0.F, 0.F)
          .row(1.F, 1.F, 1.F);
    };
    const auto refused = [&](const Ply& ply, size_t place, const std::string& part) {
      expect_error(ply.text(), byte_before_end(ply.text(), place), part);
    };
    refused(one_face("char float").row(int8_t{-1}), 1, "face 0 has a list vertex_index of -1 values");
    refused(one_face("float uchar").row(NAN), 4, "face 0 has the value nan; expected a whole number");
    refused(one_face("uchar float").row(U8{3}, 0.F, 0.5F, 1.F), 8, "face 0 has the value 0.5; expected a whole number");
    refused(one_face("uchar double").row(U8{3}, 0.0, 1.0, 1e30), 8, "face 0 has the value 1e+30");
  }
}

TEST(Ply, ReadsFilesAndPipesAndSaysWhyNot) {
  const std::string folder = testing::TempDir() + "kerf_ply_test." + std::to_string(::getpid());
  const auto what = [](const std::string& path) {
    try {
      read_ply(path);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  std::ofstream(folder + ".ply", std::ios::binary) << square(Format::little).text();
  expect_square(read_ply(folder + ".ply"));
  std::ofstream(folder + ".ply", std::ios::binary) << "ply\nfromat ascii 1.0\n";
  EXPECT_EQ(what(folder + ".ply"), folder + ".ply:2: unknown word 'fromat' in the header; did you mean 'format'?");
  std::ofstream(folder + ".ply", std::ios::binary | std::ios::trunc).flush();
  EXPECT_EQ(what(folder + ".ply"), folder + ".ply:1: is not a PLY: the file is empty");
  ::unlink((folder + ".ply").c_str());
  EXPECT_EQ(what(folder + ".ply"), folder + ".ply: there is no such file");
  EXPECT_EQ(what(testing::TempDir()), testing::TempDir() + ": is a folder; a file was expected");

  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  const std::string text = square(Format::big).text() + std::string(300000, ' ');  // more than a pipe holds
  std::thread writer([&] {
    EXPECT_EQ(::write(ends[1], text.data(), text.size()), static_cast<ssize_t>(text.size()));
    ::close(ends[1]);
  });
  expect_square(read_ply("/dev/fd/" + std::to_string(ends[0])));
  writer.join();
  ::close(ends[0]);
}

TEST(NearestWord, FindsTypingErrorsAndNothingElse) {
  constexpr std::string_view kMenu[] = {"binned_sah", "sweep_sah", "spatial_split", "ploc", "x"};
  EXPECT_EQ(nearest_word("bined_sah", kMenu), "binned_sah");
  EXPECT_EQ(nearest_word("PLOC", kMenu), "ploc");
  EXPECT_EQ(nearest_word("polc", kMenu), "ploc");  // one swap
  EXPECT_EQ(nearest_word("spatialsplits", kMenu), "spatial_split");
  EXPECT_EQ(nearest_word("early_split", kMenu), "");
  EXPECT_EQ(nearest_word("y", kMenu), "");  // shares no letter
  EXPECT_EQ(nearest_word("", kMenu), "");
  EXPECT_EQ(nearest_word(std::string(1000000, 'a'), kMenu), "");
  EXPECT_EQ(nearest_word("ploc", {}), "");
}

}  // namespace
}  // namespace kerf::test
