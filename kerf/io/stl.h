#pragma once

#include <span>
#include <string>

#include "kerf/io/mesh.h"

namespace kerf {

/// Reads an STL file, ascii or binary (told apart by the size that a binary one states, as ascii's first word is no
/// sign of it). Exactly equal vertices are joined, -0 and 0 being equal, so that what touches in the file touches in
/// the mesh; they keep the order in which they are met. The file's normals are passed over: they are those of the
/// triangles; and so are a binary file's attribute bytes. An ascii file may hold several solids, with words in any case
/// of letters. No facets at all give no triangles.
///
/// Throws Error (file) with the path as place where the file cannot be read, and else as parse_stl() does.
Mesh read_stl(const std::string& path);

/// Reads an STL out of memory; `name` stands for it in errors. Throws Error (file) with the place "NAME:LINE" for
/// ascii, "NAME, byte OFFSET" for binary, and Error (too_large) for more different vertices than 32 bits count.
Mesh parse_stl(std::span<const char> bytes, const std::string& name);

}  // namespace kerf
