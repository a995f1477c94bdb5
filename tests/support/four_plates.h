#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "kerf/geometry/geometry.h"
#include "kerf/trace/trace_table.h"

namespace kerf::test {

/// Four triangles across the x axis, at x = 0.5, 1.5, 2.5 and 3.5, numbers 0 to 3: the corners of unit squares with
/// y + z <= 1. And one along it, number 4, below all of them at y = -1.
struct FourPlates {
  std::vector<Vec3f> vertices;
  std::vector<TriangleCorners> triangles;
  Geometry geometry;

  explicit FourPlates(bool with_floor = false) {
    for (uint32_t i = 0; i < 4; ++i) {
      const float x = static_cast<float>(i) + 0.5F;
      vertices.insert(vertices.end(), {{x, 0, 0}, {x, 1, 0}, {x, 0, 1}});
      triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    if (with_floor) {
      vertices.insert(vertices.end(), {{0, -1, 0}, {4, -1, 0}, {0, -1, 1}});
      triangles.push_back({12, 13, 14});
    }
    geometry = {TriangleMesh{std::span<const Vec3f>(vertices), std::span<const TriangleCorners>(triangles)}};
  }
  std::span<const Geometry> geometries() const { return {&geometry, 1}; }
};

/// A hit and the work that it took.
struct Outcome {
  Hit hit;
  TraceCounts counts;
};
inline Outcome closest(const TraceTable& table, const void* data, const Ray& ray) {
  Outcome outcome;
  outcome.hit = table.closest_counted(data, ray, outcome.counts);
  EXPECT_EQ(table.closest(data, ray), outcome.hit);
  EXPECT_EQ(table.any(data, ray), static_cast<bool>(outcome.hit));
  return outcome;
}

inline void expect_counts(const TraceCounts& counts, uint64_t nodes, uint64_t primitives, uint64_t boxes) {
  EXPECT_EQ(counts.nodes, nodes);
  EXPECT_EQ(counts.primitives, primitives);
  EXPECT_EQ(counts.boxes, boxes);
}

}  // namespace kerf::test
