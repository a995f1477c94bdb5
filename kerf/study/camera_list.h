#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kerf/io/camera.h"

namespace kerf {

/// A camera that a folder of models keeps for one of them: a row of its cameras.tsv.
struct ListedCamera {
  std::string scene;  ///< the model's file name without its end
  std::string name;
  Camera camera;
};

/// All rows of FOLDER/cameras.tsv: scene, camera, eye x y z, look-at x y z, up x y z, vertical field of view in
/// degrees, under a row of names. Throws Error (file) for a table that cannot be read, with the line.
std::vector<ListedCamera> read_camera_list(const std::string& folder);

/// The first camera that the table beside a model has for it; nothing without a table or a row.
std::optional<Camera> listed_camera(const std::string& model_path);

}  // namespace kerf
