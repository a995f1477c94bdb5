#pragma once

#include <span>
#include <string>

#include "kerf/io/model.h"

namespace kerf {

/// Reads a Wavefront OBJ file with its MTL files (mtllib, relative to the OBJ's folder) and their textures.
///
/// v, vt, vn, f (polygons cut as fans from their first corner; v, v/t, v//n and v/t/n; negative numbers count from the
/// end), usemtl and mtllib are read; o, g, s, l, p and what else the format has is passed over. Lines may end in \r\n
/// and go on after a backslash. Triangles keep the order of the file, flat ones included. Normals and texture
/// coordinates are there only where a face names them.
///
/// The model's materials are those that triangles have, in the order of their first use; triangles before the first
/// usemtl have a default one. Libraries and textures that are not there leave default materials and a note. See
/// parse_mtl() for what is read of a library.
///
/// Throws Error (file) with the place "NAME:LINE": a number that is none, an index out of range, a face with fewer than
/// three corners, a line cut short, an unknown keyword (with the nearest right word), a material that is in none of the
/// libraries; in a library that is there, what parse_mtl() says; with a texture's path as place, an image that is
/// damaged. Error (too_large) for more vertices than 32 bits count. Memory stays in proportion to the bytes. The same
/// for any number of threads.
Model read_obj(const std::string& path);

/// Reads an OBJ out of memory; `name` stands for it in errors, and libraries are looked for in the folder of this name.
Model parse_obj(std::span<const char> bytes, const std::string& name);

}  // namespace kerf
