#pragma once

#include <span>
#include <vector>

#include "kerf/trace/trace_table.h"
#include "kerf/trace/triangle_filter.h"
#include "kerf/tree/bvh.h"

namespace kerf {

/// Tests every primitive: slow, and simple enough to be right. Triangles that a ray surely misses are passed over many
/// at a time; all others, and all spheres and parallelograms, get the same test as everywhere.
class BruteForce {
 public:
  BruteForce() = default;
  BruteForce(std::span<const Geometry> geometries, std::span<const LeafSlot> slots);

  /// How many primitives it tests.
  size_t size() const { return triangle_slots_.size() + other_slots_.size(); }

  /// Of the kernel that passes triangles over.
  std::string_view instruction_set() const { return kernels_.instruction_set; }

  size_t bytes() const { return triangles_.bytes() + size() * sizeof(LeafSlot); }

  template <bool kAny, class Counts>
  Hit trace(const Ray& ray, Counts& counts) const;

 private:
  std::span<const Geometry> geometries_;
  TriangleColumns triangles_;
  std::vector<LeafSlot> triangle_slots_, other_slots_;
  TriangleKernels kernels_{};
};

const TraceTable& brute_force_table();

}  // namespace kerf
