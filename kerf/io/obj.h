#pragma once

#include <string>

#include "kerf/io/model.h"

namespace kerf {

/// Reads a Wavefront OBJ file with its MTL files (mtllib, relative to the OBJ's folder).
///
/// v, vt, vn, f (polygons cut as fans from their first corner; v, v/t, v//n and v/t/n; negative numbers count from the
/// end), usemtl and mtllib are read; o, g, s, l, p and what else the format has is passed over. Lines may end in \r\n
/// and go on after a backslash. Triangles keep the order of the file, flat ones included.
///
/// Throws Error (file) with the place "NAME:LINE": a number that is none, an index out of range, a face with fewer than
/// three corners, a line cut short, an unknown keyword (with the nearest right word), a material or library that does
/// not exist. Memory stays in proportion to the bytes.
Model read_obj(const std::string& path);

}  // namespace kerf
