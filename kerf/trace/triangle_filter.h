#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "kerf/geometry/prepared_ray.h"

namespace kerf {

/// Triangles as nine columns of floats, padded so that a kernel may read full vectors of any width.
class TriangleColumns {
 public:
  static constexpr size_t kPadding = 64;

  void reserve(size_t count);
  void add(const Triangle& triangle);
  /// After the last add(): pads with triangles that no ray hits.
  void finish();

  const float* column(size_t corner, size_t axis) const { return columns_[corner * 3 + axis].data(); }
  size_t bytes() const { return 9 * columns_[0].size() * sizeof(float); }

 private:
  std::array<std::vector<float>, 9> columns_;
  size_t size_ = 0;
};

/// Writes the numbers of the triangles in [begin, end) that the ray may hit, in order, to `out`, which needs room for
/// end - begin + kPadding; returns how many. Leaves out none that intersect() would accept.
using TriangleFilter = size_t (*)(const TriangleColumns& triangles, const PreparedRay& ray, size_t begin, size_t end,
                                  uint32_t* out);

/// What one instruction set offers.
struct TriangleKernels {
  TriangleFilter filter;
  std::string_view instruction_set;  ///< its name
};

/// The kernels for the chosen_instruction_set(), whose errors it throws; to be asked once, not for each ray.
TriangleKernels triangle_kernels();

}  // namespace kerf
