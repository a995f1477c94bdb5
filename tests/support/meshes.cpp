#include "tests/support/meshes.h"

#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace kerf::test {
namespace {

constexpr double kPi = std::numbers::pi;

Vec3d normalized(Vec3d v) { return v / std::sqrt(dot(v, v)); }

/// A prism with side walls between two rings of equal length, closed by fans from their centres.
Solid closed_tower(std::string name, const std::vector<Vec3d>& bottom, const std::vector<Vec3d>& top,
                   Vec3d bottom_center, Vec3d top_center) {
  Solid solid{std::move(name), bottom, {}, {}};
  solid.vertices.insert(solid.vertices.end(), top.begin(), top.end());
  solid.vertices.push_back(bottom_center);
  solid.vertices.push_back(top_center);
  const auto count = static_cast<uint32_t>(bottom.size());
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t next = (i + 1) % count;
    solid.triangles.push_back({i, next, count + next});
    solid.triangles.push_back({i, count + next, count + i});
    solid.triangles.push_back({next, i, 2 * count});
    solid.triangles.push_back({count + i, count + next, 2 * count + 1});
  }
  for (const double share : {0.5, 0.37, 0.61}) {
    solid.inner.push_back(bottom_center * (1 - share) + top_center * share);
  }
  return solid;
}

}  // namespace

Solid icosphere(int levels) {
  const double g = std::numbers::phi;
  Solid solid{"icosphere",
              {{-1, g, 0},
               {1, g, 0},
               {-1, -g, 0},
               {1, -g, 0},
               {0, -1, g},
               {0, 1, g},
               {0, -1, -g},
               {0, 1, -g},
               {g, 0, -1},
               {g, 0, 1},
               {-g, 0, -1},
               {-g, 0, 1}},
              {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
               {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
               {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}},
              {{0, 0, 0}, {0.31, -0.22, 0.4}, {-0.6, 0.1, 0.3}}};
  for (Vec3d& v : solid.vertices) v = normalized(v);
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> middles;
    const auto middle = [&](uint32_t a, uint32_t b) {
      const auto [place, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<uint32_t>(solid.vertices.size()));
      if (is_new) solid.vertices.push_back(normalized(solid.vertices[a] + solid.vertices[b]));
      return place->second;
    };
    std::vector<TriangleCorners> finer;
    for (const auto& [a, b, c] : solid.triangles) {
      const uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const TriangleCorners& t : {TriangleCorners{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}}) {
        finer.push_back(t);
      }
    }
    solid.triangles = std::move(finer);
  }
  return solid;
}

Solid torus(double tube, uint32_t around, uint32_t across) {
  Solid solid{"torus", {}, {}, {}};
  for (uint32_t i = 0; i < around; ++i) {
    const double a = 2 * kPi * i / around;
    for (uint32_t j = 0; j < across; ++j) {
      const double b = 2 * kPi * j / across, radius = 1 + tube * std::cos(b);
      solid.vertices.push_back({radius * std::cos(a), radius * std::sin(a), tube * std::sin(b)});
      const uint32_t i2 = (i + 1) % around, j2 = (j + 1) % across;
      const uint32_t p = i * across + j, q = i2 * across + j, r = i2 * across + j2, s = i * across + j2;
      solid.triangles.push_back({p, q, r});
      solid.triangles.push_back({p, r, s});
    }
  }
  for (const double a : {0.0, 1.1, 4.0}) solid.inner.push_back({std::cos(a), std::sin(a), 0.1 * tube});
  return solid;
}

Solid sliver_tower(double height, uint32_t strips) {
  constexpr double kCorners[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  std::vector<Vec3d> bottom, top;
  for (uint32_t side = 0; side < 4; ++side) {
    const auto& from = kCorners[side];
    const auto& to = kCorners[(side + 1) % 4];
    for (uint32_t i = 0; i < strips; ++i) {
      const double share = static_cast<double>(i) / strips;
      bottom.push_back({from[0] + (to[0] - from[0]) * share, from[1] + (to[1] - from[1]) * share, 0});
      top.push_back(bottom.back() + Vec3d{0, 0, height});
    }
  }
  Solid solid = closed_tower("sliver_tower", bottom, top, {0, 0, 0}, {0, 0, height});
  solid.inner.push_back({0.3, -0.4, 0.2 * height});
  return solid;
}

Solid cog(uint32_t teeth) {
  std::vector<Vec3d> bottom, top;
  const Transform turn = then(rotation(kX, 31), then(rotation(kY, -17), rotation(kZ, 53)));
  for (uint32_t i = 0; i < 2 * teeth; ++i) {
    const double angle = kPi * i / teeth, radius = i % 2 == 0 ? 1 : 0.7;
    bottom.push_back(turn.point({radius * std::cos(angle), radius * std::sin(angle), -0.8}));
    top.push_back(turn.point({0.6 * radius * std::cos(angle + 0.1), 0.6 * radius * std::sin(angle + 0.1), 0.9}));
  }
  return closed_tower("cog", bottom, top, turn.point({0, 0, -0.8}), turn.point({0, 0, 0.9}));
}

PlacedSolid place(const Solid& solid, double scale, Vec3d offset) {
  PlacedSolid placed{{}, solid.triangles, {}};
  for (const Vec3d& v : solid.vertices) placed.vertices.push_back(to_float(v * scale + offset));
  for (const Vec3d& v : solid.inner) placed.inner.push_back(to_float(v * scale + offset));
  return placed;
}

size_t count_open_edges(const std::vector<TriangleCorners>& triangles) {
  std::map<std::pair<uint32_t, uint32_t>, int> directed;
  for (const TriangleCorners& t : triangles) {
    for (size_t i = 0; i < 3; ++i) ++directed[{t[i], t[(i + 1) % 3]}];
  }
  size_t open = 0;
  for (const auto& [edge, count] : directed) {
    const auto partner = directed.find({edge.second, edge.first});
    if (count != 1 || partner == directed.end() || partner->second != 1) ++open;
  }
  return open;
}

Real winding_number(const PlacedSolid& solid, Vec3f point) {
  Real sum = 0;
  for (const TriangleCorners& t : solid.triangles) {
    const Vec3r a = to_real(solid.vertices[t[0]]) - to_real(point), b = to_real(solid.vertices[t[1]]) - to_real(point),
                c = to_real(solid.vertices[t[2]]) - to_real(point);
    const Real la = length(a), lb = length(b), lc = length(c);
    // Van Oosterom, Strackee: The Solid Angle of a Plane Triangle, 1983.
    sum += std::atan2(volume(a, b, c), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return sum / (2 * std::numbers::pi_v<Real>);
}

}  // namespace kerf::test
