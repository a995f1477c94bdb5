#pragma once

#include <random>
#include <vector>

#include "kerf/geometry/geometry.h"

namespace kerf::test {

/// Triangles between random points: `long_share` of them long, thin and turned at will, the others small.
struct RandomTriangles {
  std::vector<Vec3f> vertices;
  std::vector<TriangleCorners> triangles;

  explicit RandomTriangles(uint32_t count, uint32_t seed = 1, float long_share = 0.2F) {
    std::mt19937 random(seed);
    const auto number = [&](float from, float to) {
      // Not std::uniform_real_distribution: its outcome differs between libraries.
      return from + (to - from) * (static_cast<float>(random() >> 8) * 0x1p-24F);
    };
    const auto point = [&](float size) { return Vec3f{number(-size, size), number(-size, size), number(-size, size)}; };
    for (uint32_t i = 0; i < count; ++i) {
      const bool is_long = number(0, 1) < long_share;
      const Vec3f corner = point(10), side = point(is_long ? 8.0F : 0.3F), width = point(is_long ? 0.05F : 0.3F);
      vertices.insert(vertices.end(), {corner, corner + side, corner + side * 0.5F + width});
      triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
  }

  Geometry geometry() const {
    return {TriangleMesh{std::span<const Vec3f>(vertices), std::span<const TriangleCorners>(triangles)}};
  }
};

}  // namespace kerf::test
