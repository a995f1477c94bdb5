// Closed meshes without files: what watertightness is tested on.

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "kerf/base/transform.h"
#include "kerf/geometry/shapes.h"
#include "tests/support/exact.h"

namespace kerf::test {

/// Vertices in double, as they are meant; place() rounds them.
struct Solid {
  std::string name;
  std::vector<Vec3d> vertices;
  std::vector<TriangleCorners> triangles;  ///< counter-clockwise seen from outside
  std::vector<Vec3d> inner;                ///< points well inside
};

/// A sphere of radius 1: an icosahedron, each triangle cut in four `levels` times.
Solid icosphere(int levels);

/// Around the z axis, radii 1 and `tube`, `around` times `across` quads of two triangles.
Solid torus(double tube, uint32_t around, uint32_t across);

/// A square tower, 2 wide and `height` high, each side `strips` strips over the whole height, the lids fans from their
/// centres; the slivers are 0.5 * height * strips times as long as wide.
Solid sliver_tower(double height, uint32_t strips);

/// A cog that narrows and twists towards its top, turned off all axes: a few large sloped faces.
Solid cog(uint32_t teeth);

/// A solid as a scene takes it, scaled, moved and rounded to float.
struct PlacedSolid {
  std::vector<Vec3f> vertices;
  std::vector<TriangleCorners> triangles;
  std::vector<Vec3f> inner;

  TriangleMesh mesh() const {
    return {Strided<Vec3f>(vertices.data(), vertices.size()),
            Strided<TriangleCorners>(triangles.data(), triangles.size())};
  }
};
PlacedSolid place(const Solid& solid, double scale, Vec3d offset);

/// How many edges lack their one partner of the opposite direction: 0 for a closed manifold.
size_t count_open_edges(const std::vector<TriangleCorners>& triangles);

/// How often the surface winds around a point, from the solid angles of its triangles: 1 inside, 0 outside.
Real winding_number(const PlacedSolid& solid, Vec3f point);

}  // namespace kerf::test
