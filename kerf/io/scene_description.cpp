#include "kerf/io/scene_description.h"

#include <utility>

#include "kerf/base/error.h"
#include "kerf/base/letter_case.h"
#include "kerf/io/model.h"
#include "kerf/io/yaml_scene.h"

namespace kerf {
namespace {

bool ends_with_yaml(const std::string& path) {
  const std::string name = lower_case(path);
  return name.ends_with(".yaml") || name.ends_with(".yml");
}

SceneDescription read_bare_model(const std::string& path) {
  Model model = read_model(path);
  if (model.mesh.triangles.empty()) {
    throw Error(ErrorCode::file, path, "there is no face in it, so nothing to see");
  }
  SceneDescription scene;
  scene.camera = model.camera;
  scene.materials = std::move(model.materials);
  if (scene.materials.empty()) scene.materials.emplace_back();
  scene.textures = std::move(model.textures);
  scene.objects.push_back({std::move(model.mesh), 0, true, path});
  scene.is_lit = false;
  for (const std::string& note : model.notes) scene.notes.push_back(path + ": " + note);
  return scene;
}

}  // namespace

SceneDescription read_scene(const std::string& path) {
  if (!ends_with_yaml(path)) return read_bare_model(path);
#ifdef KERF_HAVE_YAML
  return read_yaml_scene(path);
#else
  throw Error(ErrorCode::file, path, "this build has no yaml-cpp, so it reads no YAML scenes");
#endif
}

}  // namespace kerf
