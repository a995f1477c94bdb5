#pragma once

#include <span>
#include <string>
#include <vector>

#include "kerf/io/mesh.h"
#include "kerf/io/obj/obj_scan.h"

namespace kerf {

/// Reads all that scan_obj() has counted: vertices, triangles and their attributes, but no materials. Appends to
/// `notes` what the file has that a mesh cannot hold. Throws Error (file) for the first thing that is wrong in the
/// file, and Error (too_large) for more vertices than 32 bits count. The same for any number of threads.
Mesh read_obj_geometry(std::span<const char> text, std::span<const ObjChunk> chunks, const std::string& name,
                       std::vector<std::string>& notes);

}  // namespace kerf
