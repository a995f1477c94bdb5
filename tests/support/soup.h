#pragma once

#include <vector>

#include "kerf/geometry/shapes.h"

namespace kerf::test {

/// Triangles that share no vertices.
struct Soup {
  std::vector<Vec3f> vertices;
  std::vector<TriangleCorners> triangles;

  void add(Vec3f a, Vec3f b, Vec3f c) {
    const auto first = static_cast<uint32_t>(vertices.size());
    vertices.insert(vertices.end(), {a, b, c});
    triangles.push_back({first, first + 1, first + 2});
  }
  void add(const Triangle& t) { add(t.a, t.b, t.c); }
  TriangleMesh mesh() const { return {{vertices.data(), vertices.size()}, {triangles.data(), triangles.size()}}; }
  Triangle triangle(uint32_t i) const { return mesh().triangle(i); }
};

}  // namespace kerf::test
