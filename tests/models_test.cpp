// The models that are made: their sizes, that they repeat, and what each is about.

#include "kerf/study/models/models.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "kerf/base/parallel.h"
#include "kerf/study/models/random.h"
#include "tests/support/error_of.h"
#include "tests/support/meshes.h"

namespace kerf::test {
namespace {

/// The longest edge over the height on it, or infinity for a triangle without area.
double slenderness(const Mesh& mesh, const Mesh::Corners& t) {
  const Vec3d a = to_double(mesh.vertices[t[0]]), b = to_double(mesh.vertices[t[1]]),
              c = to_double(mesh.vertices[t[2]]);
  const Vec3d normal = cross(b - a, c - a);
  const double square = std::max({dot(b - a, b - a), dot(c - b, c - b), dot(a - c, a - c)});
  return square / std::sqrt(dot(normal, normal));
}

bool is_axis_aligned(const Mesh& mesh, const Mesh::Corners& t) {
  for (uint32_t axis = 0; axis < 3; ++axis) {
    const float at = mesh.vertices[t[0]][axis];
    if (mesh.vertices[t[1]][axis] == at && mesh.vertices[t[2]][axis] == at) return true;
  }
  return false;
}

TEST(Models, AreNamedInOrder) {
  const std::span<const ModelEntry> all = made_models();
  ASSERT_FALSE(all.empty());
  EXPECT_TRUE(std::is_sorted(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.name < b.name; }));
  EXPECT_NE(error_of(ErrorCode::invalid_option, [] { make_model("miror", 10, 0); }).find("'mirror'"),
            std::string::npos);
  EXPECT_NE(error_of(ErrorCode::too_large, [] { make_model("soup", uint64_t{1} << 31, 0); }), "");
  EXPECT_NE(error_of(ErrorCode::too_large, [] { make_model("needles", 0x7FFFFFFF, 0); }).find("vertices"),
            std::string::npos);
}

TEST(Models, HaveAboutTheTrianglesAskedFor) {
  for (const ModelEntry& entry : made_models()) {
    for (const uint64_t wanted : {10'000U, 77'777U}) {
      const auto made = static_cast<double>(entry.make(wanted, 3).mesh.triangles.size());
      EXPECT_NEAR(made, static_cast<double>(wanted), 0.05 * static_cast<double>(wanted)) << entry.name;
    }
    for (const uint64_t few : {0U, 500U}) {
      const size_t made = entry.make(few, 1).mesh.triangles.size();
      EXPECT_GT(made, 0U) << entry.name;
      EXPECT_LT(made, 10'000U) << entry.name;
    }
  }
}

TEST(Models, AreSound) {
  for (const ModelEntry& entry : made_models()) {
    SCOPED_TRACE(entry.name);
    const MadeModel model = entry.make(50'000, 5);
    const Mesh& mesh = model.mesh;
    size_t flat = 0;
    for (const auto& t : mesh.triangles) {
      for (const uint32_t corner : t) ASSERT_LT(corner, mesh.vertices.size());
      flat += std::isfinite(slenderness(mesh, t)) ? 0 : 1;
    }
    EXPECT_EQ(flat, 0U);
    for (const Vec3f v : mesh.vertices) ASSERT_TRUE(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z));
    const Vec3d forward = model.camera.look_at - model.camera.eye;
    EXPECT_GT(dot(forward, forward), 0);
    EXPECT_GT(model.camera.fov, 0);
  }
}

TEST(Models, RepeatAndChangeWithTheSeed) {
  for (const ModelEntry& entry : made_models()) {
    SCOPED_TRACE(entry.name);
    MadeModel one, many;
    with_threads(1, [&] { one = entry.make(20'000, 7); });
    with_threads(4, [&] { many = entry.make(20'000, 7); });
    EXPECT_EQ(one.mesh.vertices, many.mesh.vertices);
    EXPECT_EQ(one.mesh.triangles, many.mesh.triangles);
    const bool has_chance = entry.name != "mirror" && entry.name != "stadium";
    EXPECT_EQ(entry.make(20'000, 8).mesh.vertices != one.mesh.vertices, has_chance);
  }
}

TEST(Models, TheMirrorIsClosedAtThePapersTwoLevels) {
  for (const uint64_t wanted : {85'651U, 334'080U}) {
    const Mesh mesh = make_mirror(wanted, 0).mesh;
    EXPECT_NEAR(static_cast<double>(mesh.triangles.size()), static_cast<double>(wanted),
                0.02 * static_cast<double>(wanted));
    EXPECT_EQ(count_open_edges(mesh.triangles), 0U);
    const auto thin = std::count_if(mesh.triangles.begin(), mesh.triangles.end(),
                                    [&](const auto& t) { return slenderness(mesh, t) > 10; });
    EXPECT_GT(static_cast<double>(thin), 0.04 * static_cast<double>(mesh.triangles.size())) << "CAD has long triangles";
  }
}

TEST(Models, ThePlantIsLongPipesAndAFewSlabs) {
  const Mesh mesh = make_plant(200'000, 1).mesh;
  constexpr double kSlabTriangles = 12, kMostPipeTriangles = 2 * 13;
  double slab = 0, long_ones = 0;
  for (const auto& t : mesh.triangles) {
    if (is_axis_aligned(mesh, t)) {
      ++slab;
    } else {
      long_ones += slenderness(mesh, t) > 50 ? 1 : 0;  // as its side is narrower than the radius, or hardly wider
    }
  }
  const double pipe = static_cast<double>(mesh.triangles.size()) - slab;
  EXPECT_GT(long_ones, 0.98 * pipe);
  const double slabs = slab / kSlabTriangles;
  EXPECT_GT(slabs / (slabs + pipe / kMostPipeTriangles), 0.04);
  EXPECT_LT(slabs / (slabs + pipe / kMostPipeTriangles), 0.08);
}

TEST(Models, TheStadiumsTeapotIsSmall) {
  const Mesh mesh = make_stadium(100'000, 0).mesh;
  const auto in_middle = std::count_if(mesh.triangles.begin(), mesh.triangles.end(), [&](const auto& t) {
    const Vec3f v = mesh.vertices[t[0]];
    return std::abs(v.x) < 0.2F && std::abs(v.z) < 0.2F;
  });
  EXPECT_GT(in_middle, 70'000);
  float far = 0;
  for (const Vec3f v : mesh.vertices) far = std::max(far, std::abs(v.x));
  EXPECT_GT(far, 80);
}

TEST(Models, NumbersAreEvenlySpread) {
  ModelRandom random(1, 2);
  Vec3d direction;
  double share = 0;
  constexpr int kCount = 20'000;
  for (int i = 0; i < kCount; ++i) {
    const Vec3d d = random.direction();
    ASSERT_NEAR(dot(d, d), 1, 1e-12);
    direction = direction + d / kCount;
    share += random.share() / kCount;
    const double octaves = random.between_octaves(2, 32);
    ASSERT_TRUE(octaves >= 2 && octaves <= 32);
    ASSERT_LT(random.below(7), 7U);
  }
  EXPECT_LT(largest(abs(direction)), 0.02);
  EXPECT_NEAR(share, 0.5, 0.01);
  EXPECT_NE(ModelRandom(1, 3).bits(), ModelRandom(1, 2).bits());
  EXPECT_NE(ModelRandom(2, 2).bits(), ModelRandom(1, 2).bits());
  EXPECT_EQ(ModelRandom(1, 2).bits(), ModelRandom(1, 2).bits());
}

}  // namespace
}  // namespace kerf::test
