// The regular tessellator: edges, joints, areas and counts.

#include "kerf/study/models/tessellate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "kerf/base/parallel.h"
#include "kerf/study/models/surfaces.h"
#include "tests/support/error_of.h"
#include "tests/support/meshes.h"

namespace kerf::test {
namespace {

constexpr double kPi = std::numbers::pi;

/// A closed part with what it should measure.
struct Part {
  std::string name;
  Faces faces;
  double area = 0, volume = 0;  // 0: no closed form
};

Surface sphere() {
  return [](double u, double v) {
    const double out = std::sin(kPi * v);
    return Vec3d{out * std::cos(2 * kPi * u), out * std::sin(2 * kPi * u), -std::cos(kPi * v)};
  };
}

Surface torus(double tube) {
  return [=](double u, double v) {
    const double out = 1 + tube * std::cos(2 * kPi * v);
    return Vec3d{out * std::cos(2 * kPi * u), out * std::sin(2 * kPi * u), tube * std::sin(2 * kPi * v)};
  };
}

Sheets bent_plate() {
  const auto sheet = [](double z) { return [=](double s, double t) { return Vec3d{s, t, z + 0.2 * s * t}; }; };
  Sheets plate{sheet(0.1), sheet(0), {0, 1, 2, 3}, {0, 1, 2}, {{1, 0, 0.3, 0.2}, {2, 1, 0.1, 0.3}}};
  return plate;
}

std::vector<Part> closed_parts() {
  std::vector<Part> parts;
  parts.push_back({"sphere", {sphere()}, 4 * kPi, 4 * kPi / 3});
  parts.push_back({"torus", {torus(0.3)}, 4 * kPi * kPi * 0.3, 2 * kPi * kPi * 0.09});
  parts.push_back({"cylinder", {}, 2 * kPi * 0.5 * (3 + 0.5), kPi * 0.25 * 3});
  add_cylinder(parts.back().faces, 0.5, 3, rotation(kX, 30));
  parts.push_back({"box", {}, 2 * (2 + 3 + 6), 6});
  add_box(parts.back().faces, {-1, 0, 0}, {0, 2, 3});
  parts.push_back({"fillets", {}});
  add_revolved(parts.back().faces, {{0, 0}, {1, 0, 0.2}, {1, 1, 0.3}, {0.5, 1, 0.1}, {0.5, 2, 0.1}, {0, 2}}, {});
  parts.push_back({"plate", {}});
  add_sheets(parts.back().faces, bent_plate());
  parts.push_back({"round plate", {}});
  Sheets rounded = bent_plate();
  rounded.round_rim = [](Vec3d p) { return Vec3d{p.x - 1.5, p.y - 1, 0}; };
  add_sheets(parts.back().faces, rounded);
  parts.push_back({"sweep", {}});
  const Curve path = bezier_curve({Vec3d{0, 0, 0}, {1, 0, 0}, {1, 0, 2}, {2, 0.5, 2}});
  add_sweep(parts.back().faces, {rounded_rectangle_profile(0.4, 0.2, 0.05), path, {0, 1, 0}, 2});
  return parts;
}

double longest_edge(const Mesh& mesh) {
  double longest = 0;
  for (const auto& t : mesh.triangles) {
    for (uint32_t i = 0; i < 3; ++i) {
      const Vec3d edge = to_double(mesh.vertices[t[i]]) - to_double(mesh.vertices[t[(i + 1) % 3]]);
      longest = std::max(longest, std::sqrt(dot(edge, edge)));
    }
  }
  return longest;
}

double area_of(const Mesh& mesh) {
  double area = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3d a = to_double(mesh.vertices[t[0]]);
    const Vec3d n = cross(to_double(mesh.vertices[t[1]]) - a, to_double(mesh.vertices[t[2]]) - a);
    area += std::sqrt(dot(n, n)) / 2;
  }
  return area;
}

double volume_of(const Mesh& mesh) {
  double volume = 0;
  for (const auto& t : mesh.triangles) {
    volume +=
        dot(to_double(mesh.vertices[t[0]]), cross(to_double(mesh.vertices[t[1]]), to_double(mesh.vertices[t[2]]))) / 6;
  }
  return volume;
}

TEST(Tessellate, NoEdgeIsLongerThanAllowed) {
  for (const Part& part : closed_parts()) {
    const Tessellator tessellator(part.faces);
    for (const double edge : {1.0, 0.3, 0.07}) {
      const double longest = longest_edge(tessellator.mesh({edge}));
      EXPECT_LE(longest, edge) << part.name;
      EXPECT_GT(longest, edge * 0.5) << part.name;
    }
  }
}

TEST(Tessellate, ClosedPartsStayClosedAndFaceOutward) {
  for (const Part& part : closed_parts()) {
    const Tessellator tessellator(part.faces);
    for (const Fineness& fineness :
         {Fineness{}, Fineness{0.5}, Fineness{0.11}, Fineness{1e9, 0.01}, Fineness{0.4, 1e-4}}) {
      const Mesh mesh = tessellator.mesh(fineness);
      EXPECT_EQ(count_open_edges(mesh.triangles), 0U) << part.name << " " << fineness.max_edge;
      EXPECT_GT(volume_of(mesh), 0) << part.name;
      EXPECT_EQ(mesh.triangles.size() % 2, 0U) << part.name;
    }
  }
}

TEST(Tessellate, AreaAndVolumeConverge) {
  for (const Part& part : closed_parts()) {
    if (part.area == 0) continue;
    const Tessellator tessellator(part.faces);
    const bool is_flat = part.name == "box";
    double last = std::numeric_limits<double>::infinity();
    for (const double edge : {0.4, 0.2, 0.1, 0.05}) {
      const Mesh mesh = tessellator.mesh({edge});
      const double error = std::abs(area_of(mesh) - part.area) / part.area;
      EXPECT_LT(error, is_flat ? 1e-6 : last / 3) << part.name << " " << edge;
      last = error;
    }
    EXPECT_LT(last, 1e-2) << part.name;
    EXPECT_NEAR(volume_of(tessellator.mesh({0.05})), part.volume, part.volume * 1e-2) << part.name;
  }
}

TEST(Tessellate, HalfTheEdgeIsFourTimesTheTriangles) {
  for (const Part& part : closed_parts()) {
    const Tessellator tessellator(part.faces);
    const double coarse = static_cast<double>(tessellator.mesh({0.04}).triangles.size());
    const double fine = static_cast<double>(tessellator.mesh({0.02}).triangles.size());
    EXPECT_NEAR(fine / coarse, 4, 0.8) << part.name;
  }
}

TEST(Tessellate, CountIsWhatIsMade) {
  for (const Part& part : closed_parts()) {
    const Tessellator tessellator(part.faces);
    for (const double edge : {1.0, 0.1}) {
      const auto made = static_cast<double>(tessellator.mesh({edge}).triangles.size());
      EXPECT_NEAR(static_cast<double>(tessellator.count({edge})), made, 0.15 * made) << part.name;
    }
    EXPECT_EQ(tessellator.count({0.5, 0.01}) % 2, 0U);
  }
}

TEST(Tessellate, WhatIsStraightIsCutByItsEdgeAlone) {
  Faces faces;
  add_cylinder(faces, 0.1, 10, {});
  const Tessellator tube(faces);
  constexpr double kChord = 1e-4;
  const Mesh mesh = tube.mesh({1e9, kChord});
  // Around, as many segments as keep within the chord; along, one: lids of n and a side of 2 n triangles.
  const double around = static_cast<double>(mesh.triangles.size()) / 4;
  EXPECT_NEAR(around, kPi / std::acos(1 - kChord / 0.1), 2);
  EXPECT_GT(longest_edge(mesh), 10);
  EXPECT_EQ(tube.mesh({20, kChord}).triangles.size(), mesh.triangles.size());
  EXPECT_GT(tube.mesh({5, kChord}).triangles.size(), mesh.triangles.size());
}

TEST(Tessellate, IsTheSameForAnyNumberOfThreads) {
  Faces faces;
  add_sheets(faces, bent_plate());
  Mesh one, many;
  with_threads(1, [&] { one = Tessellator(faces).mesh({0.05}); });
  with_threads(4, [&] { many = Tessellator(faces).mesh({0.05}); });
  EXPECT_EQ(one.vertices, many.vertices);
  EXPECT_EQ(one.triangles, many.triangles);
}

TEST(Tessellate, SaysWhatIsWrong) {
  const Surface hole = [](double u, double v) { return Vec3d{u, v, 1 / (u - 0.5)}; };
  EXPECT_NE(error_of(ErrorCode::invalid_geometry,
                     [&] {
                       Tessellator({sphere(), hole});
                     })
                .find("face 1"),
            std::string::npos);
  const Tessellator ball({sphere()});
  for (const Fineness& bad : {Fineness{0}, Fineness{-1}, Fineness{std::nan("")}, Fineness{1, 0}}) {
    EXPECT_NE(error_of(ErrorCode::invalid_option, [&] { ball.mesh(bad); }), "");
  }
  EXPECT_NE(error_of(ErrorCode::too_large, [&] { ball.mesh({1e-6}); }), "");
  const Surface cliff = [](double u, double v) { return Vec3d{u, v, u > 0.54 ? 5.0 : 0.0}; };
  EXPECT_NE(error_of(ErrorCode::invalid_geometry, [&] { Tessellator({cliff}).mesh({0.5}); }).find("uneven"),
            std::string::npos);
  EXPECT_TRUE(Tessellator({}).mesh({1}).triangles.empty());
}

TEST(Tessellate, FindsANumberOfTriangles) {
  Faces faces;
  add_sheets(faces, bent_plate());
  const Tessellator plate(faces);
  for (const uint64_t wanted : {1'000U, 20'000U, 300'000U}) {
    const auto made = static_cast<double>(tessellate_to(plate, wanted, {0.3, 0.001}).triangles.size());
    EXPECT_NEAR(made, static_cast<double>(wanted), 0.1 * static_cast<double>(wanted));
  }
}

}  // namespace
}  // namespace kerf::test
