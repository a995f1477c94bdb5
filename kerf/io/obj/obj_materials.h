#pragma once

#include <span>
#include <string>

#include "kerf/io/model.h"
#include "kerf/io/obj/obj_scan.h"

namespace kerf {

/// Gives a model, of which the mesh has been read, the materials that its usemtl statements name, in the order of their
/// first use, out of the libraries that its mtllib statements name, with their textures. Throws Error (file) as
/// read_obj() says.
void add_obj_materials(std::span<const char> text, std::span<const ObjChunk> chunks, const std::string& name,
                       Model& model);

}  // namespace kerf
