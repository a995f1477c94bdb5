#pragma once

#include <string>
#include <vector>

#include "kerf/io/model.h"

namespace kerf {

/// Reads any format that Assimp knows, its nodes placed by their transforms, with colours, base colour textures,
/// emission and smooth normals. Throws Error (file) with the path as place.
///
/// The readers are Assimp's own, and not all of them stand damaged files: one of a seldom used format may take much
/// time or memory, or, rarely, end the program. Those known to do so often are left out (ASE, COB, IQM, MD5, SIB), and
/// OpenGEX, whose reader prints.
Model read_with_assimp(const std::string& path);

/// The ends of names that Assimp reads, such as ".fbx", in order.
std::vector<std::string> assimp_extensions();

}  // namespace kerf
