#pragma once

#include <string>

#include "kerf/io/mesh.h"

namespace kerf {

/// Reads an STL file, ascii or binary (told apart by the size that a binary one states, as ascii's first word is no
/// sign of it). Exactly equal vertices are joined, so that what touches in the file touches in the mesh. The file's
/// normals are passed over: they are those of the triangles.
///
/// Throws Error (file) with the place "NAME:LINE" or "NAME, byte OFFSET".
Mesh read_stl(const std::string& path);

}  // namespace kerf
