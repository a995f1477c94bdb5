#pragma once

#include <span>
#include <string>

#include "kerf/io/mesh.h"

namespace kerf {

/// Reads a triangle mesh from a PLY 1.0 file, ascii or binary of either byte order.
///
/// Vertices are x, y, z of element `vertex`, of any scalar type. Triangles come from the lists `vertex_indices` (or
/// `vertex_index`) of element `face`, polygons cut as fans from their first corner, and of element `tristrips`, where
/// -1 starts a new strip and every second triangle is turned so that all wind alike. Elements may stand in any order,
/// and other properties and elements are passed over. Triangles keep the order of the file, flat ones included. No
/// faces at all give no triangles. What follows the last element is ignored.
///
/// Throws Error (file) with the path as place where the file cannot be read, and else as parse_ply() does.
Mesh read_ply(const std::string& path);

/// Reads a PLY out of memory; `name` stands for it in errors. Throws Error (file) with the place "NAME:LINE" for the
/// header and for ascii, "NAME, byte OFFSET" for binary, and Error (too_large) for more vertices than 32 bits count.
/// Memory stays in proportion to the bytes, whatever they say.
Mesh parse_ply(std::span<const char> bytes, const std::string& name);

}  // namespace kerf
