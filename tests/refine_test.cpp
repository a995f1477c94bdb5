// Geometry refinement: small triangles worked by hand, closed meshes that stay closed, boxes, caps.

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <map>
#include <string>

#include "kerf/base/parallel.h"
#include "kerf/references/refine.h"
#include "kerf/scene/scene.h"
#include "tests/support/error_of.h"
#include "tests/support/exact.h"
#include "tests/support/meshes.h"
#include "tests/support/random_scene.h"

namespace kerf::test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

using Measure = Refinement::Measure;

TriangleMesh mesh_of(const std::vector<Vec3f>& vertices, const std::vector<TriangleCorners>& triangles) {
  return {Strided<Vec3f>(vertices.data(), vertices.size()),
          Strided<TriangleCorners>(triangles.data(), triangles.size())};
}
TriangleMesh mesh_of(const RefinedMesh& mesh) { return mesh_of(mesh.vertices, mesh.triangles); }

SplitResult refine_geometry(const Geometry& geometry, const Refinement& options) {
  const std::span<const Geometry> geometries(&geometry, 1);
  return refine(geometries, make_references(geometries).references, options);
}

Real area_of(const Triangle& t) { return length(cross(to_real(t.b) - to_real(t.a), to_real(t.c) - to_real(t.a))) / 2; }
Real area_of(const TriangleMesh& mesh) {
  Real sum = 0;
  for (uint32_t i = 0; i < mesh.triangles.size(); ++i) sum += area_of(mesh.triangle(i));
  return sum;
}
Real longest_side(const Triangle& t) {
  const Vec3r a = to_real(t.a), b = to_real(t.b), c = to_real(t.c);
  return std::max({length(b - a), length(c - b), length(a - c)});
}

/// The small triangles of one triangle by their corners, in order.
std::vector<std::vector<Vec3f>> pieces_of(const std::vector<Vec3f>& corners, const Refinement& options) {
  const std::vector<TriangleCorners> triangles = {{0, 1, 2}};
  const RefinedMesh refined = refine_mesh(mesh_of(corners, triangles), options);
  std::vector<std::vector<Vec3f>> pieces;
  for (const auto& [a, b, c] : refined.triangles) {
    pieces.push_back({refined.vertices[a], refined.vertices[b], refined.vertices[c]});
  }
  return pieces;
}

TEST(RefineMesh, AllSidesTooLongGiveFour) {
  const std::vector<std::vector<Vec3f>> expected = {{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}},
                                                    {{4, 0, 0}, {2, 2, 0}, {2, 0, 0}},
                                                    {{0, 4, 0}, {0, 2, 0}, {2, 2, 0}},
                                                    {{2, 0, 0}, {2, 2, 0}, {0, 2, 0}}};
  const std::vector<Vec3f> triangle = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};  // sides 4, 5.66, 4; area 8
  EXPECT_EQ(pieces_of(triangle, {.limit = 3}), expected);
  EXPECT_EQ(pieces_of(triangle, {.measure = Measure::area, .limit = 2}), expected);
  EXPECT_EQ(pieces_of(triangle, {.measure = Measure::area, .limit = 1.99}).size(), 16U);
  EXPECT_EQ(pieces_of(triangle, {.limit = 6}).size(), 1U);
}

TEST(RefineMesh, TwoSidesTooLongGiveThree) {
  // Sides 1, 4.03, 4.03: the halves are 2.02 long; all diagonals are shorter than 3.
  const std::vector<std::vector<Vec3f>> expected = {{{0.5F, 4, 0}, {0.25F, 2, 0}, {0.75F, 2, 0}},
                                                    {{0, 0, 0}, {1, 0, 0}, {0.75F, 2, 0}},
                                                    {{0, 0, 0}, {0.75F, 2, 0}, {0.25F, 2, 0}}};
  EXPECT_EQ(pieces_of({{0, 0, 0}, {1, 0, 0}, {0.5F, 4, 0}}, {.limit = 3}), expected);
}

TEST(RefineMesh, OneSideTooLongGivesTwo) {
  const std::vector<std::vector<Vec3f>> expected = {{{4, 0, 0}, {2, 0, 0}, {2, 1, 0}},
                                                    {{2, 0, 0}, {0, 0, 0}, {2, 1, 0}}};
  EXPECT_EQ(pieces_of({{2, 1, 0}, {4, 0, 0}, {0, 0, 0}}, {.limit = 3}), expected);
}

/// The same solid with three vertices of its own for each triangle.
PlacedSolid torn(const PlacedSolid& solid) {
  PlacedSolid soup;
  for (const auto& [a, b, c] : solid.triangles) {
    const auto first = static_cast<uint32_t>(soup.vertices.size());
    soup.vertices.insert(soup.vertices.end(), {solid.vertices[a], solid.vertices[b], solid.vertices[c]});
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  return soup;
}

TEST(RefineMesh, ClosedMeshesStayClosed) {
  for (const Solid& solid : {icosphere(1), torus(0.3, 12, 7), sliver_tower(9, 5), cog(7)}) {
    const PlacedSolid placed = place(solid, 1.7, {3, -2, 1});
    for (const PlacedSolid& given : {placed, torn(placed)}) {
      const Real area = area_of(given.mesh());
      for (const Measure measure : {Measure::edge, Measure::area}) {
        for (const double limit : {2.0, 0.5, 0.2}) {
          const double asked = measure == Measure::edge ? limit : limit * limit;
          const RefinedMesh refined = refine_mesh(given.mesh(), {measure, asked, 1e6});
          EXPECT_EQ(count_open_edges(refined.triangles), 0U) << solid.name << " " << limit;
          EXPECT_NEAR(static_cast<double>(area_of(mesh_of(refined)) / area), 1, 1e-5) << solid.name << " " << limit;
          EXPECT_EQ(refined.limit, asked);
          EXPECT_FALSE(refined.capped);
          for (uint32_t i = 0; i < refined.triangles.size(); ++i) {
            const Triangle t = mesh_of(refined).triangle(i);
            ASSERT_LE(measure == Measure::edge ? longest_side(t) : area_of(t), asked * 1.0001L) << solid.name;
          }
        }
      }
    }
  }
}

TEST(RefineMesh, WithoutALimitIsTheSameMesh) {
  const PlacedSolid solid = place(torus(0.3, 12, 7), 1, {});
  const RefinedMesh refined = refine_mesh(solid.mesh(), {});
  ASSERT_EQ(refined.triangles.size(), solid.triangles.size());
  EXPECT_EQ(refined.vertices.size(), solid.vertices.size());
  for (uint32_t i = 0; i < refined.triangles.size(); ++i) {
    const Triangle a = solid.mesh().triangle(i), b = mesh_of(refined).triangle(i);
    EXPECT_TRUE(a.a == b.a && a.b == b.b && a.c == b.c);
    EXPECT_EQ(refined.originals[i], i);
  }
}

TEST(RefineMesh, WeightsTellWhereEachCornerLies) {
  const RandomTriangles random(200);
  const TriangleMesh mesh = std::get<TriangleMesh>(random.geometry().shapes);
  for (const Measure measure : {Measure::edge, Measure::area}) {
    const RefinedMesh refined = refine_mesh(mesh, Refinement::with_budget(20, measure));
    EXPECT_GT(refined.triangles.size(), 2000U);
    EXPECT_LE(refined.triangles.size(), 4000U);
    for (uint32_t i = 0; i < refined.triangles.size(); ++i) {
      const Triangle whole = mesh.triangle(refined.originals[i]);
      for (uint32_t k = 0; k < 3; ++k) {
        const auto [u, v] = refined.weights[i][k];
        const Vec3r p = to_real(whole.a) * (Real{1} - u - v) + to_real(whole.b) * Real{u} + to_real(whole.c) * Real{v};
        ASSERT_LE(length(p - to_real(refined.vertices[refined.triangles[i][k]])), 2e-6L);
      }
    }
  }
}

TEST(RefineMesh, ANeighbourWithoutAreaStaysClosedToo) {
  // A flat pillow of two triangles whose one side has a third vertex on it, bridged by a triangle without area.
  const std::vector<Vec3f> vertices = {{0, 0, 0}, {8, 0, 0}, {0, 8, 0}, {4, 0, 0}};
  const std::vector<TriangleCorners> triangles = {{0, 1, 2}, {2, 1, 3}, {2, 3, 0}, {0, 3, 1}};
  ASSERT_EQ(count_open_edges(triangles), 0U);
  for (const Measure measure : {Measure::edge, Measure::area}) {
    const RefinedMesh refined = refine_mesh(mesh_of(vertices, triangles), {measure, 1.5, 1000});
    EXPECT_GT(refined.triangles.size(), 20U);
    EXPECT_EQ(count_open_edges(refined.triangles), 0U);
  }
}

TEST(RefineMesh, RefusesWhatItCannotRead) {
  const std::vector<Vec3f> vertices = {{0, 0, 0}, {8, 0, 0}, {0, 8, 0}};
  const std::vector<TriangleCorners> triangles = {{0, 1, 2}, {0, 1, 3}};
  const std::string text =
      error_of(ErrorCode::invalid_geometry, [&] { refine_mesh(mesh_of(vertices, triangles), {.limit = 1}); });
  EXPECT_NE(text.find("triangle 1"), std::string::npos) << text;
  error_of(ErrorCode::invalid_option, [&] { refine_mesh(mesh_of(vertices, triangles), {.limit = 0}); });
  EXPECT_TRUE(refine_mesh(TriangleMesh{}, {.limit = 1}).triangles.empty());
}

bool holds(const Box3f& box, const Box3f& inner) { return box.contains(inner.lower) && box.contains(inner.upper); }

TEST(Refine, BoxesAreThoseOfTheSmallTriangles) {
  const PlacedSolid solid = place(cog(9), 2, {0.1, 0.2, 0.3});
  for (const Measure measure : {Measure::edge, Measure::area}) {
    const Refinement options = Refinement::with_budget(9, measure);
    const RefinedMesh mesh = refine_mesh(solid.mesh(), options);
    const SplitResult split = refine_geometry(Geometry{solid.mesh()}, options);
    EXPECT_EQ(split.limit, mesh.limit);
    EXPECT_GT(split.references.size(), 4 * solid.triangles.size());
    ASSERT_EQ(split.references.size(), mesh.triangles.size());
    for (uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      const Reference& piece = split.references[i];
      EXPECT_EQ(piece.primitive, mesh.originals[i]);
      const Box3f box = primitive_bounds(Geometry{mesh_of(mesh)}, i);  // of rounded corners
      for (uint32_t axis = 0; axis < 3; ++axis) {
        ASSERT_NEAR(piece.lower[axis], box.lower[axis], 5e-7);
        ASSERT_NEAR(piece.upper[axis], box.upper[axis], 5e-7);
      }
      ASSERT_TRUE(holds(primitive_bounds(Geometry{solid.mesh()}, piece.primitive), piece.bounds()));
    }
  }
}

TEST(Refine, BoxesAreExactAndRoundedOutward) {
  // Halves of floats: exact. The third coordinate cannot be halved in float, so both sides of it are in the box.
  const float odd = next_above(1.0F);
  const std::vector<Vec3f> vertices = {{0, 0, 1}, {4, 0, odd}, {0, 4, 1}};
  const std::vector<TriangleCorners> triangles = {{0, 1, 2}};
  const SplitResult split = refine_geometry(Geometry{mesh_of(vertices, triangles)}, {.limit = 3});
  ASSERT_EQ(split.references.size(), 4U);
  EXPECT_EQ(split.references[0].bounds(), (Box3f{{0, 0, 1}, {2, 2, odd}}));
  EXPECT_EQ(split.references[1].bounds(), (Box3f{{2, 0, 1}, {4, 2, odd}}));
  EXPECT_EQ(split.references[2].bounds(), (Box3f{{0, 2, 1}, {2, 4, odd}}));
  EXPECT_EQ(split.references[3].bounds(), (Box3f{{0, 0, 1}, {2, 2, odd}}));
}

TEST(Refine, ParallelogramsAreHalvedAlongBothSidesAndSpheresStayWhole) {
  const Parallelogram shape{{0, 0, 1}, {4, 0, 0}, {0, 2, 0}};
  const Geometry geometry{Strided<Parallelogram>(&shape, 1)};
  EXPECT_EQ(refine_geometry(geometry, {.limit = 4}).references.size(), 1U);
  EXPECT_EQ(refine_geometry(geometry, {.limit = 2}).references.size(), 2U);
  EXPECT_EQ(refine_geometry(geometry, {.limit = 1}).references.size(), 8U);
  const SplitResult four = refine_geometry(geometry, {.measure = Measure::area, .limit = 2});
  ASSERT_EQ(four.references.size(), 4U);
  Box3f all;
  for (const Reference& piece : four.references) {
    all.extend(piece.bounds());
    EXPECT_NEAR(surface_area(piece.bounds()), 2 * 2 * 1, 1e-5);
    EXPECT_EQ(piece.lower.z, 1);
    EXPECT_EQ(piece.upper.z, 1);
  }
  EXPECT_EQ(all, (Box3f{{0, 0, 1}, {4, 2, 1}}));
  const Sphere sphere{{0, 0, 0}, 5};
  const Geometry ball{Strided<Sphere>(&sphere, 1)};
  EXPECT_EQ(refine_geometry(ball, {.limit = 0.1}).references.size(), 1U);
}

TEST(Refine, KeepsTheCapAndSaysSo) {
  const RandomTriangles random(3000);
  for (const Measure measure : {Measure::edge, Measure::area}) {
    const SplitResult free = refine_geometry(random.geometry(), {measure, 1.0, 1e6});
    EXPECT_FALSE(free.capped);
    const SplitResult capped = refine_geometry(random.geometry(), {measure, 1e-6, 3});
    EXPECT_TRUE(capped.capped);
    EXPECT_GT(capped.limit, 1e-6);
    EXPECT_LE(capped.references.size(), 9000U);
    EXPECT_GT(capped.references.size(), 5500U);
    const SplitResult again = refine_geometry(random.geometry(), {measure, capped.limit, 1e6});
    EXPECT_EQ(again.references, capped.references);
    // However absurd the limit, and however many sizes: it ends.
    EXPECT_LE(refine_geometry(random.geometry(), {measure, 1e-300, 2}).references.size(), 6000U);
  }
}

TEST(Refine, TheNumberOfThreadsDoesNotMatter) {
  const RandomTriangles random(5000);
  for (const Measure measure : {Measure::edge, Measure::area}) {
    SplitResult one, many;
    with_threads(1, [&] { one = refine_geometry(random.geometry(), Refinement::with_budget(3, measure)); });
    with_threads(5, [&] { many = refine_geometry(random.geometry(), Refinement::with_budget(3, measure)); });
    EXPECT_EQ(one.references, many.references);
    EXPECT_EQ(one.limit, many.limit);
  }
}

TEST(Refine, HitsAreThoseOfTheOriginals) {
  const RandomTriangles random(500);
  Scene plain, refined;
  plain.add(random.geometry());
  refined.add(random.geometry());
  plain.build();
  EXPECT_GT(refined.build({.structure = "refine(budget=4,by=area)+binned_sah"}).references_per_primitive, 2);
  EXPECT_EQ(refined.structure().find_fault(), std::nullopt);
  size_t hits = 0;
  for (int i = 0; i < 1000; ++i) {
    const float x = 0.02F * static_cast<float>(i) - 10;
    const Ray ray{.origin = {x, -20, 0.3F * x}, .direction = {-0.3F * x, 20, std::sin(x) * 8}};
    const Hit expected = plain.closest_hit(ray), hit = refined.closest_hit(ray);
    ASSERT_EQ(std::memcmp(&expected, &hit, sizeof(Hit)), 0);
    hits += expected ? 1 : 0;
  }
  EXPECT_GT(hits, 30U);
}

TEST(Refine, RefusesWhatCannotBeMeant) {
  const RandomTriangles random(3);
  for (const double bad : {0.0, -1.0, kNaN}) {
    error_of(ErrorCode::invalid_option, [&] { refine_geometry(random.geometry(), {.limit = bad}); });
    error_of(ErrorCode::invalid_option, [&] { refine_geometry(random.geometry(), {.limit = 1, .cap = bad}); });
  }
  const auto text_of = [&](const std::string& structure) {
    Scene scene;
    scene.add(random.geometry());
    return error_of(ErrorCode::invalid_option, [&] { scene.build({.structure = structure}); });
  };
  EXPECT_NE(text_of("refine(edge=1,area=1)+binned_sah").find("give one"), std::string::npos);
  EXPECT_NE(text_of("refine(budget=2,cap=3)+binned_sah").find("one or the other"), std::string::npos);
  EXPECT_NE(text_of("refine(edge=1,by=area)+binned_sah").find("budget"), std::string::npos);
  EXPECT_NE(text_of("refine(edge=0)+binned_sah"), "");
  EXPECT_NE(text_of("refine(edge=1)+early_split(sa_max=1)+binned_sah"), "");
}

TEST(Refine, GivesUpAtItsLimit) {
  const RandomTriangles random(2000);
  const std::vector<Geometry> geometries{random.geometry()};
  const std::vector<Reference> whole = make_references(geometries).references;
  const std::atomic<bool> cancelled = true;
  WorkLimit unwanted, late, small, tiny;
  unwanted.cancelled = &cancelled;
  late.deadline = WorkLimit::Clock::now();
  small.bytes = 3 * whole.size() * sizeof(Reference);  // enough for the references, not for their pieces
  tiny.bytes = 1000;
  for (const Refinement::Measure measure : {Refinement::Measure::edge, Refinement::Measure::area}) {
    for (const Refinement& options : {Refinement::with_budget(8, measure), Refinement{measure, 0.01, 100}}) {
      for (const WorkLimit& limit : {unwanted, late, small, tiny}) {
        error_of(ErrorCode::stopped, [&] { refine(geometries, whole, options, limit); });
      }
    }
    EXPECT_GT(refine(geometries, whole, Refinement::with_budget(2, measure), small).references.size(), whole.size());
  }
  error_of(ErrorCode::stopped, [&] { refine(geometries, whole, {}, tiny); });
}

}  // namespace
}  // namespace kerf::test
