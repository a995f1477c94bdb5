#include "tests/support/scenes.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "kerf/base/error.h"

namespace kerf::test {

std::optional<std::string> scenes_folder() {
  const char* folder = std::getenv("KERF_SCENES");
  if (folder == nullptr || *folder == '\0') return std::nullopt;
  return folder;
}

std::vector<SceneCamera> read_cameras(const std::string& folder) {
  const std::string path = folder + "/cameras.tsv";
  std::ifstream file(path);
  if (!file) throw Error(ErrorCode::file, path, "cannot be read");
  std::vector<SceneCamera> cameras;
  std::string line;
  std::getline(file, line);  // the names of the columns
  for (int number = 2; std::getline(file, line); ++number) {
    std::istringstream row(line);
    SceneCamera entry;
    Camera& c = entry.camera;
    row >> entry.scene >> entry.name >> c.eye.x >> c.eye.y >> c.eye.z >> c.look_at.x >> c.look_at.y >> c.look_at.z >>
        c.up.x >> c.up.y >> c.up.z >> c.fov;
    if (!row) throw Error(ErrorCode::file, path + ":" + std::to_string(number), "expected 12 columns");
    if (std::filesystem::exists(folder + "/" + entry.scene + ".ply")) cameras.push_back(entry);
  }
  return cameras;
}

Transform turn_by_name(const std::string& name) {
  if (name == "straight") return {};
  if (name == "x") return rotation(kX, 30);
  if (name == "y") return rotation(kY, 30);
  if (name == "z") return rotation(kZ, 30);
  if (name == "xyz") return then(then(rotation(kX, 30), rotation(kY, 30)), rotation(kZ, 30));
  throw Error(ErrorCode::invalid_option, "turn", "'" + name + "' is none of straight, x, y, z and xyz");
}

std::vector<Ray> camera_rays(const Camera& camera, uint32_t width, uint32_t height) {
  const CameraRays pixel(camera, width, height);
  std::vector<Ray> rays;
  for (uint32_t y = 0; y < height; ++y) {
    for (uint32_t x = 0; x < width; ++x) rays.push_back(pixel.center(x, y));
  }
  return rays;
}

Mesh turned(Mesh mesh, const Transform& turn) {
  for (Vec3f& vertex : mesh.vertices) vertex = to_float(turn.point(to_double(vertex)));
  return mesh;
}

Camera turned(const Camera& camera, const Transform& turn) {
  return {turn.point(camera.eye), turn.point(camera.look_at), turn.vector(camera.up), camera.fov};
}

}  // namespace kerf::test
