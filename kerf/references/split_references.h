#pragma once

#include <vector>

#include "kerf/references/early_split.h"

namespace kerf {

/// For builders other than Kerf's: the boxes of a mesh's triangles, large ones cut into several, each with the number
/// of its triangle (`primitive`; `geometry` is 0). Feed them to any builder that takes boxes; a Reference has the very
/// layout of Embree's RTCBuildPrimitive. Triangles without area get no box. The mesh is neither changed nor kept.
/// Throws Error(invalid_geometry) for a triangle that is not finite or has a bad index, unless `skip_invalid`;
/// Error(invalid_option) as early_split() does.
inline std::vector<Reference> split_references(const TriangleMesh& mesh, const EarlySplit& options = {},
                                               bool skip_invalid = false) {
  const Geometry geometry{mesh};
  const std::span<const Geometry> geometries(&geometry, 1);
  PrimitiveReferences whole = make_references(geometries, skip_invalid);
  return early_split(whole.references, geometry_clipper(geometries), options).references;
}

}  // namespace kerf
