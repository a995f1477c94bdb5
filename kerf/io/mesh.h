#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "kerf/base/vec3.h"

namespace kerf {

/// A triangle mesh as a file gives it: triangles are indices into `vertices`, counter-clockwise seen from outside
/// where the file keeps to that. Readers check that indices are in range; vertices may be non-finite and triangles
/// flat, which is for the scene to judge.
struct Mesh {
  std::vector<Vec3f> vertices;
  std::vector<std::array<uint32_t, 3>> triangles;
};

}  // namespace kerf
