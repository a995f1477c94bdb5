#include "kerf/study/camera_list.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include "kerf/base/error.h"

namespace kerf {

std::vector<ListedCamera> read_camera_list(const std::string& folder) {
  const std::string path = (std::filesystem::path(folder) / "cameras.tsv").string();
  std::ifstream file(path);
  if (!file) throw Error(ErrorCode::file, path, "it cannot be read");
  std::vector<ListedCamera> cameras;
  std::string line;
  std::getline(file, line);  // the names of the columns
  for (int number = 2; std::getline(file, line); ++number) {
    std::istringstream row(line);
    ListedCamera entry;
    Camera& c = entry.camera;
    row >> entry.scene >> entry.name >> c.eye.x >> c.eye.y >> c.eye.z >> c.look_at.x >> c.look_at.y >> c.look_at.z >>
        c.up.x >> c.up.y >> c.up.z >> c.fov;
    if (!row) throw Error(ErrorCode::file, path + ":" + std::to_string(number), "expected 12 columns");
    cameras.push_back(entry);
  }
  return cameras;
}

std::optional<Camera> listed_camera(const std::string& model_path) {
  const std::filesystem::path path = model_path;
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  if (!std::filesystem::exists(folder / "cameras.tsv")) return std::nullopt;
  for (const ListedCamera& entry : read_camera_list(folder.string())) {
    if (entry.scene == path.stem().string()) return entry.camera;
  }
  return std::nullopt;
}

}  // namespace kerf
