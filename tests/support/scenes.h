#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kerf/base/transform.h"
#include "kerf/io/mesh.h"
#include "kerf/render/camera.h"

namespace kerf::test {

/// A scene's camera, a row of cameras.tsv.
struct SceneCamera {
  std::string scene;
  std::string name;
  Camera camera;
};

/// The folder of real scenes that KERF_SCENES names, with cameras.tsv; nothing where it is not set.
std::optional<std::string> scenes_folder();

/// The cameras of all scenes whose PLY is in the folder. Throws Error(file) for a table that cannot be read.
std::vector<SceneCamera> read_cameras(const std::string& folder);

/// A turn by name: "straight", "x", "y" or "z" (30 degrees about that axis), "xyz" (about x, then y, then z).
/// Throws Error(invalid_option) for another name.
Transform turn_by_name(const std::string& name);

/// One ray through the centre of each pixel, row by row from the top.
std::vector<Ray> camera_rays(const Camera& camera, uint32_t width, uint32_t height);

Mesh turned(Mesh mesh, const Transform& turn);
Camera turned(const Camera& camera, const Transform& turn);

}  // namespace kerf::test
