// The scene as its users meet it: order of calls, errors, moves, batches, and the caller's floating-point mode.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "kerf/base/error.h"
#include "kerf/scene/scene.h"
#include "tests/support/hostile_float.h"
#include "tests/support/random.h"
#include "tests/support/structures.h"

namespace kerf::test {
namespace {

const std::vector<Vec3f> kVertices = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {0, 0, 2}, {1, 0, 2}, {0, 1, 2}};
const std::vector<TriangleCorners> kTriangles = {{0, 1, 2}, {3, 4, 5}};
const Ray kRay{.origin = {0.25F, 0.25F, 0}, .direction = {0, 0, 1}};

TriangleMesh mesh_of(const std::vector<Vec3f>& vertices, const std::vector<TriangleCorners>& triangles) {
  return {{vertices.data(), vertices.size()}, {triangles.data(), triangles.size()}};
}

template <class F>
void expect_error(ErrorCode code, F&& f) {
  try {
    f();
    ADD_FAILURE() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
  }
}

void expect_not_built(const Scene& scene) {
  TraceCounts counts;
  std::vector<Ray> rays(2000, kRay);
  std::vector<Hit> hits(2000);
  std::vector<uint8_t> any(2000);
  expect_error(ErrorCode::not_built, [&] { scene.closest_hit(kRay); });
  expect_error(ErrorCode::not_built, [&] { scene.any_hit(kRay); });
  expect_error(ErrorCode::not_built, [&] { scene.closest_hit(kRay, counts); });
  expect_error(ErrorCode::not_built, [&] { scene.any_hit(kRay, counts); });
  for (const int threads : {0, 1, 2}) {
    expect_error(ErrorCode::not_built, [&] { scene.closest_hit(rays, hits, threads); });
    expect_error(ErrorCode::not_built, [&] { scene.any_hit(rays, any, threads); });
  }
  expect_error(ErrorCode::not_built, [&] { scene.report(); });
  expect_error(ErrorCode::not_built, [&] { scene.bounds(); });
  expect_error(ErrorCode::not_built, [&] { scene.normal({}); });
}

TEST(Scene, AnswersOnlyAfterBuild) {
  Scene scene;
  expect_not_built(scene);
  EXPECT_EQ(scene.add(mesh_of(kVertices, kTriangles)), 0U);
  expect_not_built(scene);
  scene.build();
  EXPECT_EQ(scene.closest_hit(kRay).primitive, 0U);
  EXPECT_EQ(scene.bounds(), (Box3f{{0, 0, 1}, {1, 1, 2}}));
  EXPECT_EQ(scene.normal(scene.closest_hit(kRay)), (Vec3f{0, 0, 1}));
}

TEST(Scene, WhatIsAddedLaterIsSeenAfterTheNextBuild) {
  Scene scene;
  scene.build();
  EXPECT_FALSE(scene.closest_hit(kRay));
  scene.add(mesh_of(kVertices, kTriangles));
  EXPECT_FALSE(scene.closest_hit(kRay));
  scene.build();
  EXPECT_TRUE(scene.closest_hit(kRay));
}

TEST(Scene, AFailedBuildKeepsTheFormerOne) {
  std::vector<Vec3f> bad = kVertices;
  bad[4].x = std::nanf("");
  Scene scene;
  scene.add(mesh_of(kVertices, kTriangles));
  const std::string structure = scene.build({.structure = "sweep_sah"}).structure;
  scene.add(mesh_of(bad, kTriangles));
  expect_error(ErrorCode::invalid_geometry, [&] { scene.build(); });
  expect_error(ErrorCode::invalid_option, [&] { scene.build({.structure = "binned_shah"}); });
  expect_error(ErrorCode::invalid_option, [&] { scene.build({.structure = ""}); });
  EXPECT_EQ(scene.report().structure, structure);
  EXPECT_EQ(scene.report().primitives, 2U);
  EXPECT_EQ(scene.closest_hit(kRay).t, 1);
  EXPECT_TRUE(scene.any_hit(kRay));
  EXPECT_EQ(scene.build({.skip_invalid = true}).invalid, 1U) << "and it can still be built";
}

TEST(Scene, MovesWithWhatItKnows) {
  Scene scene;
  scene.add(mesh_of(kVertices, kTriangles));
  scene.build();
  Scene moved(std::move(scene));
  EXPECT_EQ(moved.closest_hit(kRay).t, 1);
  expect_not_built(scene);  // NOLINT(bugprone-use-after-move): what is left is promised
  EXPECT_EQ(scene.add(mesh_of(kVertices, kTriangles)), 0U);
  scene.build();
  EXPECT_EQ(scene.closest_hit(kRay).t, 1);
  Scene target;
  target.build();
  target = std::move(moved);
  EXPECT_EQ(target.closest_hit(kRay).t, 1);
  expect_not_built(moved);  // NOLINT(bugprone-use-after-move)
  moved.build();
  EXPECT_FALSE(moved.closest_hit(kRay)) << "a scene that was moved from is an empty one";
  Scene& same = target;
  target = std::move(same);
  EXPECT_EQ(target.closest_hit(kRay).t, 1);
  EXPECT_EQ(target.add(mesh_of(kVertices, kTriangles)), 1U);
}

TEST(Scene, BatchesGiveWhatSingleRaysDo) {
  Random random(1);
  Scene scene;
  scene.add(mesh_of(kVertices, kTriangles));
  scene.build();
  std::vector<Ray> rays;
  for (int i = 0; i < 5000; ++i) rays.push_back({.origin = random.vector(), .direction = random.vector()});
  for (const int threads : {0, 1, 2, 7}) {
    std::vector<Hit> hits(rays.size());
    std::vector<uint8_t> any(rays.size(), 77);
    scene.closest_hit(rays, hits, threads);
    scene.any_hit(rays, any, threads);
    size_t count = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
      ASSERT_EQ(hits[i], scene.closest_hit(rays[i]));
      ASSERT_EQ(any[i], hits[i] ? 1 : 0);
      count += any[i];
    }
    EXPECT_GT(count, 100U);
  }
  scene.closest_hit(std::span<const Ray>(), std::span<Hit>());
}

TEST(Scene, BatchesOfUnequalLengthAreRefused) {
  Scene scene;
  scene.build();
  std::vector<Ray> rays(3, kRay);
  std::vector<Hit> hits(2);
  std::vector<uint8_t> any(4);
  expect_error(ErrorCode::invalid_argument, [&] { scene.closest_hit(rays, hits); });
  expect_error(ErrorCode::invalid_argument, [&] { scene.any_hit(rays, any, 1); });
}

TEST(Scene, StridesAndUnalignedMemoryAreReadAsTheyStand) {
  // Each vertex behind one byte, with three bytes of something else after it.
  std::vector<std::byte> bytes(16 * kVertices.size() + 1, std::byte{0xFF});
  for (size_t i = 0; i < kVertices.size(); ++i) std::memcpy(bytes.data() + 16 * i + 1, &kVertices[i], sizeof(Vec3f));
  Scene scene;
  scene.add(TriangleMesh{{bytes.data() + 1, kVertices.size(), 16}, {kTriangles.data(), kTriangles.size()}});
  scene.build({.structure = "early_split(budget=2)+binned_sah"});
  EXPECT_EQ(scene.closest_hit(kRay).t, 1);
}

TEST(Closer, IsAStrictTotalOrder) {
  std::vector<Hit> hits;
  for (const float t : {0.0F, 1.0F, std::numeric_limits<float>::infinity()}) {
    for (const uint32_t instance : {0U, 3U, kNone}) {
      for (const uint32_t geometry : {0U, 2U, kNone}) {
        for (const uint32_t primitive : {0U, 7U, kNone}) hits.push_back({t, 0, 0, primitive, geometry, instance});
      }
    }
  }
  // They were made in the order that closer() promises, so it must be that of their places.
  for (size_t i = 0; i < hits.size(); ++i) {
    for (size_t j = 0; j < hits.size(); ++j) EXPECT_EQ(closer(hits[i], hits[j]), i < j) << i << ' ' << j;
  }
}

TEST(Sizes, AreThosePromised) {
  EXPECT_EQ(sizeof(Hit), 24U);
  EXPECT_EQ(sizeof(Ray), 40U);
  EXPECT_FALSE(Hit{});
  EXPECT_EQ(Hit{}.t, std::numeric_limits<float>::infinity());
}

#if defined(KERF_HOSTILE_FLOAT)
TEST(Scene, TheCallersFloatingPointModeChangesNothing) {
  for (const float size : {1.0F, 1e-38F, 1e-40F, 1e-42F}) {
    Random random(3);
    std::vector<Vec3f> vertices;
    std::vector<TriangleCorners> triangles;
    std::vector<Sphere> spheres;
    std::vector<Ray> rays;
    for (uint32_t i = 0; i < 60; ++i) {
      for (int k = 0; k < 3; ++k) vertices.push_back(size * random.vector());
      triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
      spheres.push_back({size * random.vector(), 0.1F * size});
      for (int k = 0; k < 10; ++k) rays.push_back({.origin = size * random.vector(), .direction = random.vector()});
    }
    for (const std::string& name : all_pipelines()) {
      Scene plain, hostile;
      for (Scene* scene : {&plain, &hostile}) {
        scene->add(mesh_of(vertices, triangles));
        scene->add(Strided<Sphere>(spheres.data(), spheres.size()));
      }
      const uint64_t hash = plain.build({.structure = name}).tree_hash;
      std::vector<Hit> expected(rays.size()), got(rays.size());
      std::vector<Vec3f> normals(rays.size()), got_normals(rays.size());
      size_t hits = 0;
      for (size_t i = 0; i < rays.size(); ++i) {
        expected[i] = plain.closest_hit(rays[i]);
        normals[i] = plain.normal(expected[i]);
        hits += expected[i] ? 1 : 0;
      }
      EXPECT_GT(hits, rays.size() / 4) << name << ' ' << size;
      uint64_t got_hash = 0;
      {
        const HostileFloat mode;
        got_hash = hostile.build({.structure = name}).tree_hash;
        for (size_t i = 0; i < rays.size(); ++i) {
          got[i] = hostile.closest_hit(rays[i]);
          got_normals[i] = hostile.normal(got[i]);
        }
      }
      EXPECT_EQ(got_hash, hash) << name << ' ' << size;
      EXPECT_EQ(std::memcmp(got.data(), expected.data(), got.size() * sizeof(Hit)), 0) << name << ' ' << size;
      EXPECT_EQ(std::memcmp(got_normals.data(), normals.data(), normals.size() * sizeof(Vec3f)), 0)
          << name << ' ' << size;
    }
  }
}
#endif

TEST(Scene, RefusesNullPointersAndCountsBeyondItsNumbers) {
  const auto code_of = [](const Geometry& geometry) {
    Scene scene;
    scene.add(geometry);
    try {
      scene.build();
    } catch (const Error& error) {
      return std::optional(error.code());
    }
    return std::optional<ErrorCode>();
  };
  const Vec3f vertex;
  EXPECT_EQ(code_of({TriangleMesh{{&vertex, 1}, {nullptr, 3}}}), ErrorCode::invalid_argument);
  EXPECT_EQ(code_of({TriangleMesh{{nullptr, 1}, {}}}), ErrorCode::invalid_argument);
  EXPECT_EQ(code_of({Strided<Sphere>(nullptr, 1)}), ErrorCode::invalid_argument);
  EXPECT_EQ(code_of({Strided<Parallelogram>(nullptr, 1)}), ErrorCode::invalid_argument);
  EXPECT_EQ(code_of({Strided<Sphere>(&vertex, size_t{1} << 63)}), ErrorCode::too_large);
  EXPECT_EQ(code_of({TriangleMesh{}}), std::nullopt);
}

}  // namespace
}  // namespace kerf::test
