// Primitives of all kinds in memory of their own, to be moved.

#pragma once

#include <vector>

#include "kerf/geometry/geometry.h"
#include "kerf/geometry/hit.h"
#include "tests/support/random.h"

namespace kerf::test {

struct MovingThings {
  std::vector<Vec3f> vertices;
  std::vector<TriangleCorners> triangles;
  std::vector<Sphere> spheres;
  std::vector<Parallelogram> parallelograms;

  void add(const Triangle& t) {
    const auto first = static_cast<uint32_t>(vertices.size());
    vertices.insert(vertices.end(), {t.a, t.b, t.c});
    triangles.push_back({first, first + 1, first + 2});
  }
  std::vector<Geometry> geometries() const {
    const Strided<Vec3f> points(vertices.data(), vertices.size());
    return {{TriangleMesh{points, {triangles.data(), triangles.size()}}},
            {Strided<Sphere>(spheres.data(), spheres.size())},
            {Strided<Parallelogram>(parallelograms.data(), parallelograms.size())}};
  }
  /// Everything with its points moved by f(point); spheres keep their radius.
  template <class F>
  MovingThings moved(F&& f) const {
    MovingThings result = *this;
    for (Vec3f& p : result.vertices) p = f(p);
    for (Sphere& s : result.spheres) s.center = f(s.center);
    for (Parallelogram& p : result.parallelograms) {
      const Vec3f corner = f(p.corner);
      p = {corner, f(p.corner + p.u) - corner, f(p.corner + p.v) - corner};
    }
    return result;
  }
};

/// Things of all sizes around the origin, `size` across: needles, beams along the axes, flat ones, some without area.
inline MovingThings random_things(uint32_t count, uint32_t seed, float size = 10) {
  Random random(seed);
  MovingThings things;
  for (uint32_t i = 0; i < count; ++i) {
    const Vec3f at = size * random.vector();
    Vec3f along = size * (i % 3 == 0 ? 0.8F : 0.05F) * random.vector();
    Vec3f across = size * (i % 4 == 0 ? 0.005F : 0.05F) * random.vector();
    if (i % 5 == 0) along[i % 3] = along[(i + 1) % 3] = 0;  // along an axis
    if (i % 7 == 0) along[i % 3] = across[i % 3] = 0;       // in a plane of the axes
    things.add({at, at + along, i % 29 == 0 ? at + along : at + across});
    if (i % 8 == 0) things.spheres.push_back({size * random.vector(), size * (i % 32 == 0 ? 0.2F : 0.02F)});
    if (i % 8 == 1) things.parallelograms.push_back({at, along, across});
  }
  return things;
}

/// What a ray must hit: every primitive tested by the scalar truth, the closest of all.
inline Hit expected_hit(const std::vector<Geometry>& geometries, const Ray& ray) {
  const PreparedRay prepared(ray);
  Hit best;
  for (uint32_t g = 0; prepared.valid && g < geometries.size(); ++g) {
    for (uint32_t p = 0; p < primitive_count(geometries[g]); ++p) {
      Crossing c;
      if (find_defect(geometries[g], p) != Defect::none) continue;
      if (!intersect(geometries[g], p, prepared, prepared.t_max, c)) continue;
      const Hit hit{c.t, c.u, c.v, p, g, kNone};
      if (!best || closer(hit, best)) best = hit;
    }
  }
  return best;
}

}  // namespace kerf::test
