#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "kerf/base/vec3.h"

namespace kerf {

/// A triangle mesh as a file gives it: triangles are indices into `vertices`, counter-clockwise seen from outside
/// where the file keeps to that. Readers check that indices are in range; vertices may be non-finite and triangles
/// flat, which is for the scene to judge.
///
/// What only pictures need is optional, and empty where a file has none of it. Positions are shared by the triangles
/// around them whatever their other attributes are: those have corner numbers of their own where they differ.
struct Mesh {
  using Corners = std::array<uint32_t, 3>;

  std::vector<Vec3f> vertices;
  std::vector<Corners> triangles;

  std::vector<Vec3f> normals;  ///< shading normals, of any length but 0; not checked further
  std::vector<Corners>
      normal_corners;  ///< of each triangle into `normals`; kNone for a flat one; empty: as `triangles`
  std::vector<std::array<float, 2>> uvs;  ///< texture coordinates; (0, 0) is the lower left of an image
  std::vector<Corners> uv_corners;        ///< of each triangle into `uvs`, as normal_corners
  std::vector<uint32_t> materials;        ///< of each triangle; empty: all have that of the object
};

}  // namespace kerf
