#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "kerf/geometry/hit.h"
#include "kerf/geometry/ray.h"
#include "kerf/io/mesh.h"
#include "kerf/io/scene_description.h"

namespace kerf {

/// How Kerf's and the oracle's answer for one ray compare.
enum class Verdict {
  same,          ///< the same primitive or both none, t within 1e-5
  edge_tie,      ///< Kerf is right in extended precision; the ray passes an edge so closely that floats cannot tell
  coincident,    ///< both are right: two triangles at the same distance, and both contain the crossing
  oracle_wrong,  ///< Kerf is right in extended precision, the oracle is not, by more than rounding
  unexplained,   ///< anything else
};
inline constexpr int kVerdicts = 5;
const char* verdict_name(Verdict verdict);  ///< in words, such as "edge tie"

/// Judges one ray, in extended precision where the answers differ. `depth_difference` is |t - t'| / t' where both hit.
Verdict judge(const Mesh& mesh, const Ray& ray, const Hit& kerf, const Hit& oracle, double& depth_difference);

/// The same for a scene of several objects, where a geometry is its number; nothing where the answers differ about
/// something that is no triangle.
std::optional<Verdict> judge(std::span<const SceneObject> objects, const Ray& ray, const Hit& kerf, const Hit& oracle);

}  // namespace kerf
