#pragma once

#include <vector>

#include "kerf/geometry/shapes.h"
#include "tests/support/random.h"

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

/// Large triangles of all sizes, a few of them slivers.
inline Soup random_soup(size_t count, uint64_t seed) {
  Random random(seed);
  Soup soup;
  while (soup.triangles.size() < count) {
    const float size = 10 * random.share() * random.share();
    Triangle t{random.vector(), random.vector(), random.vector()};
    if (random.below(5) == 0) t.c = t.a + random.share() * (t.b - t.a) + 1e-3F * t.c;
    const Vec3f center = 10.0F * random.vector();
    soup.add({center + size * t.a, center + size * t.b, center + size * t.c});
  }
  return soup;
}

}  // namespace kerf::test
