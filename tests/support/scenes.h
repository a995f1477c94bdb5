#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kerf/render/camera.h"
#include "kerf/study/camera_list.h"
#include "kerf/study/turn.h"

namespace kerf::test {

using SceneCamera = ListedCamera;

/// The folder of real scenes that KERF_SCENES names, with cameras.tsv; nothing where it is not set.
std::optional<std::string> scenes_folder();

/// The cameras of all scenes whose PLY is in the folder. Throws Error(file) for a table that cannot be read.
std::vector<SceneCamera> read_cameras(const std::string& folder);

/// One ray through the centre of each pixel, row by row from the top.
std::vector<Ray> camera_rays(const Camera& camera, uint32_t width, uint32_t height);

}  // namespace kerf::test
