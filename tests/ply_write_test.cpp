// PLY files as they are written.

#include "kerf/io/ply_write.h"

#include <gtest/gtest.h>

#include <bit>
#include <limits>

#include "kerf/io/ply.h"
#include "tests/support/error_of.h"
#include "tests/support/folder.h"

namespace kerf::test {
namespace {

void expect_read_back(const Mesh& mesh) {
  const Folder folder;
  write_ply(folder.path("a.ply"), mesh);
  const Mesh read = read_ply(folder.path("a.ply"));
  ASSERT_EQ(read.vertices.size(), mesh.vertices.size());
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    for (uint32_t axis = 0; axis < 3; ++axis) {
      ASSERT_EQ(std::bit_cast<uint32_t>(read.vertices[i][axis]), std::bit_cast<uint32_t>(mesh.vertices[i][axis])) << i;
    }
  }
  EXPECT_EQ(read.triangles, mesh.triangles);
}

TEST(PlyWrite, IsReadBackBitForBit) {
  constexpr uint32_t kMany = 100'000;  // more than are put together at once
  Mesh mesh;
  for (uint32_t i = 0; i < kMany; ++i) {
    const auto x = static_cast<float>(i);
    mesh.vertices.push_back({x, 1 / (x + 1), -x * 1e30F});
    mesh.triangles.push_back({i, (7 * i + 1) % kMany, kMany - 1 - i});
  }
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  mesh.vertices[5] = {nan, infinity, -0.0F};
  mesh.vertices[6] = {std::numeric_limits<float>::denorm_min(), -infinity, std::numeric_limits<float>::max()};
  expect_read_back(mesh);
}

TEST(PlyWrite, AMeshMayBeEmpty) {
  expect_read_back({});
  Mesh points;
  points.vertices = {{1, 2, 3}};
  expect_read_back(points);
}

TEST(PlyWrite, LeavesNothingWhereItCannotWrite) {
  const Folder folder;
  EXPECT_NE(error_of(ErrorCode::file, [&] { write_ply(folder.path("none/a.ply"), {}); }), "");
  EXPECT_EQ(folder.count(), 0U);
}

TEST(PlyWrite, ANameEndsInPly) {
  for (const char* name : {"a.ply", "A.PLY", "x/y.z/.ply"}) EXPECT_NO_THROW(check_ply_name(name)) << name;
  for (const char* name : {"a.obj", "ply", "", "a.ply.gz", "aply"}) {
    EXPECT_NE(error_of(ErrorCode::invalid_option, [&] { check_ply_name(name); }).find(".ply"), std::string::npos)
        << name;
  }
}

}  // namespace
}  // namespace kerf::test
