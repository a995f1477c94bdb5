#pragma once

#include <string>

#include "kerf/io/mesh.h"

namespace kerf {

/// Throws Error (invalid_option) unless the name ends in .ply, in any case of letters: to be told before any work.
void check_ply_name(const std::string& path);

/// Writes the vertices and triangles of a mesh as a PLY 1.0 file, binary little-endian, every bit of a coordinate kept:
/// `float x, y, z` and `list uchar int vertex_indices`. Other attributes are left out. The file appears whole or not at
/// all.
///
/// Throws Error (file) where it cannot be written, and Error (too_large) for more vertices than an int numbers.
void write_ply(const std::string& path, const Mesh& mesh);

}  // namespace kerf
