// Trees small enough to be worked by hand.

#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "kerf/trace/trace_table.h"
#include "kerf/tree/bvh.h"

namespace kerf::test {

/// Triangles across the x axis whose boxes cover the unit square in y and z: the half with y + z <= 1, or the other.
class HandScene {
 public:
  void add(float x, bool upper_half = false) {
    const auto first = static_cast<uint32_t>(vertices_.size());
    const float corner = upper_half ? 1 : 0;
    vertices_.insert(vertices_.end(), {{x, corner, corner}, {x, 1, 0}, {x, 0, 1}});
    triangles_.push_back({first, first + 1, first + 2});
    geometry_ = {TriangleMesh{std::span<const Vec3f>(vertices_), std::span<const TriangleCorners>(triangles_)}};
  }
  std::span<const Geometry> geometries() const { return {&geometry_, 1}; }

 private:
  std::vector<Vec3f> vertices_;
  std::vector<TriangleCorners> triangles_;
  Geometry geometry_;
};

inline BvhNode inner_node(float from, float to, uint32_t first) { return {{from, 0, 0}, first, {to, 1, 1}, 0}; }
inline BvhNode leaf_node(float x, uint32_t slot) { return {{x, 0, 0}, slot, {x, 1, 1}, 1}; }

/// Four triangles at x = 1, 2, 3 and 4, each alone in its leaf:
///
///            0 [1,4]
///       1 [1,2]   2 [3,4]
///     3 [1]  4 [2]  5 [3]  6 [4]
struct SevenNodes {
  HandScene scene;

  SevenNodes() {
    for (const float x : {1.0F, 2.0F, 3.0F, 4.0F}) scene.add(x);
  }
  static Bvh bvh() {
    Bvh bvh;
    bvh.nodes = {inner_node(1, 4, 1), inner_node(1, 2, 3), inner_node(3, 4, 5), leaf_node(1, 0),
                 leaf_node(2, 1),     leaf_node(3, 2),     leaf_node(4, 3)};
    for (uint32_t i = 0; i < 4; ++i) bvh.slots.push_back({0, i});
    return bvh;
  }
  /// The same with the children of the root exchanged: 1 [3,4] over 3 [3] and 4 [4], 2 [1,2] over 5 [1] and 6 [2].
  static Bvh exchanged() {
    Bvh bvh = SevenNodes::bvh();
    bvh.nodes = {inner_node(1, 4, 1), inner_node(3, 4, 3), inner_node(1, 2, 5), leaf_node(3, 2),
                 leaf_node(4, 3),     leaf_node(1, 0),     leaf_node(2, 1)};
    return bvh;
  }

  /// From the left at y = z = 0.25, where all triangles are hit; from the right; along where none is hit; beside all.
  static Ray from_left() { return {.origin = {0, 0.25F, 0.25F}, .direction = {1, 0, 0}}; }
  static Ray from_right() { return {.origin = {10, 0.25F, 0.25F}, .direction = {-2, 0, 0}}; }
  static Ray through_boxes() { return {.origin = {0, 0.75F, 0.75F}, .direction = {1, 0, 0}}; }
  static Ray beside() { return {.origin = {0, 2, 0.25F}, .direction = {1, 0, 0}}; }
};

inline void expect_counts(const TraceCounts& counts, uint64_t nodes, uint64_t primitives, uint64_t boxes) {
  EXPECT_EQ(counts.nodes, nodes);
  EXPECT_EQ(counts.primitives, primitives);
  EXPECT_EQ(counts.boxes, boxes);
}

}  // namespace kerf::test
