#pragma once

#include <algorithm>
#include <array>

#include "kerf/base/error.h"
#include "kerf/base/parallel.h"
#include "kerf/study/models/models.h"
#include "kerf/study/models/random.h"

namespace kerf {

/// Triangles without neighbours, about the cube from 0 to 1: corners(random) gives those of each from a stream of its
/// own.
template <class Corners>
MadeModel loose_triangles(uint64_t triangles, uint64_t seed, Corners&& corners) {
  MadeModel model;
  constexpr uint64_t kMost = 0x7FFFFFFF / 3;  // vertices are numbered by an int in files
  if (triangles > kMost) throw Error(ErrorCode::too_large, "model", "loose triangles have at most 2^31 - 1 vertices");
  constexpr size_t kGrain = 4096;
  const uint64_t count = std::max<uint64_t>(triangles, 1);
  model.mesh.triangles.resize(count);
  model.mesh.vertices.resize(3 * count);
  parallel_for(count, kGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      ModelRandom random(seed, i);
      const std::array<Vec3d, 3> points = corners(random);
      const auto first = static_cast<uint32_t>(3 * i);
      for (uint32_t k = 0; k < 3; ++k) model.mesh.vertices[first + k] = to_float(points[k]);
      model.mesh.triangles[i] = {first, first + 1, first + 2};
    }
  });
  model.camera = {{1.9, 1.4, 2.6}, {0.5, 0.5, 0.5}, {0, 1, 0}, 32};
  return model;
}

}  // namespace kerf
