#pragma once

#include <string>
#include <vector>

#include "kerf/io/mesh.h"

namespace kerf {

/// Takes their normals from triangles with one that is zero or not finite, and their texture coordinates likewise, and
/// says in `notes` how many they are. Brings normals that are so short or long that their squares leave the range of a
/// float to length 1.
void drop_unusable_attributes(Mesh& mesh, std::vector<std::string>& notes);

}  // namespace kerf
