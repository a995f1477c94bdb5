#include "tests/support/scenes.h"

#include <cstdlib>
#include <filesystem>

namespace kerf::test {

std::optional<std::string> scenes_folder() {
  const char* folder = std::getenv("KERF_SCENES");
  if (folder == nullptr || *folder == '\0') return std::nullopt;
  return folder;
}

std::vector<SceneCamera> read_cameras(const std::string& folder) {
  std::vector<SceneCamera> cameras = read_camera_list(folder);
  std::erase_if(
      cameras, [&](const SceneCamera& entry) { return !std::filesystem::exists(folder + "/" + entry.scene + ".ply"); });
  return cameras;
}

std::vector<Ray> camera_rays(const Camera& camera, uint32_t width, uint32_t height) {
  const CameraRays pixel(camera, width, height);
  std::vector<Ray> rays;
  for (uint32_t y = 0; y < height; ++y) {
    for (uint32_t x = 0; x < width; ++x) rays.push_back(pixel.center(x, y));
  }
  return rays;
}

}  // namespace kerf::test
