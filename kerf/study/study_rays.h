#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kerf/base/work_limit.h"
#include "kerf/geometry/ray.h"
#include "kerf/io/camera.h"
#include "kerf/io/scene_description.h"

namespace kerf {

enum class RayKind { primary, shadow, ambient_occlusion, diffuse };

struct RayKindEntry {
  RayKind kind;
  std::string_view name;
  std::string_view sentence;
  bool any_hit;  ///< asked whether anything is hit, not what is hit first
};

/// All kinds, by name.
std::span<const RayKindEntry> ray_kinds();

/// Rays of one kind.
struct StudyRays {
  std::string kind;  ///< a name of ray_kinds(), or "loaded"
  bool any_hit = false;
  std::vector<Ray> rays;
};

/// The rays of a picture: one primary ray through each pixel, and from each of their hits one ray of every other kind
/// asked for. The same whatever structure and machine: they are drawn from a sequence that depends on the pixel alone.
/// Throws Error as build_scene() and CameraRays do,
/// and Error(stopped) where the limit says so.
std::vector<StudyRays> make_study_rays(const SceneDescription& scene, const Camera& camera, uint32_t width,
                                       uint32_t height, std::span<const RayKind> kinds, bool skip_invalid = false,
                                       const WorkLimit& limit = {});

/// Writes rays as a NumPy array (.npy, version 1.0, little-endian) of records: origin (3 f4), t_min f4, direction
/// (3 f4), t_max f4, mask u4, kind u4 (its number in ray_kinds(), 255 for loaded ones). Throws Error (file).
void save_rays(const std::string& path, std::span<const StudyRays> rays);

/// Reads what save_rays() wrote, or a plain array of shape (n, 6) or (n, 8) of f4 or f8: origin, direction, or origin,
/// t_min, direction, t_max; those are of kind "loaded". Throws Error (file) that says what is wrong with it.
std::vector<StudyRays> load_rays(const std::string& path);

}  // namespace kerf
