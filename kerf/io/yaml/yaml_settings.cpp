#include "kerf/io/yaml/yaml_settings.h"

#include <cmath>

namespace kerf {
namespace {

constexpr std::string_view kCameraKeys[] = {"position", "look_at", "up", "fov"};
constexpr std::string_view kSettingsKeys[] = {"background_color", "background_intensity", "ambient_light",
                                              "use_bvh",          "adaptive_sampling",    "structure"};
constexpr std::string_view kSceneKeys[] = {
    "name",    "description",       "camera",   "background_color", "background_intensity", "ambient_light",
    "use_bvh", "adaptive_sampling", "structure"};

double length(Vec3d v) { return std::sqrt(dot(v, v)); }

/// What a camera cannot look along has no picture; kerf/render/camera.h refuses it by the same sums.
void check_view(const Camera& camera, const YamlMap& map) {
  const auto fail = [&](std::initializer_list<std::string_view> guilty, const char* sentence) {
    for (const std::string_view key : guilty) {
      if (const std::optional<YamlField> field = map.find(key)) field->fail(sentence);
    }
    map.node().fail(sentence);
  };
  const Vec3d view = camera.look_at - camera.eye;
  if (!(length(view) > 0)) fail({"look_at", "position"}, "the camera's position and what it looks at must differ");
  const Vec3d side = cross(view / length(view), camera.up);
  if (!(length(side) > 1e-9 * length(camera.up))) {
    fail({"up", "look_at", "position"}, "the camera's up must be neither zero nor along its view");
  }
}

Camera read_camera(const std::optional<YamlField>& section) {
  Camera camera;
  camera.fov = 90;
  if (!section || section->node().is_null()) return camera;
  const YamlMap map(*section, kCameraKeys, "the camera");
  if (const auto field = map.find("position")) camera.eye = field->vector();
  if (const auto field = map.find("look_at")) camera.look_at = field->vector();
  if (const auto field = map.find("up")) camera.up = field->vector();
  if (const auto field = map.find("fov")) camera.fov = field->number({0, 180, true});
  check_view(camera, map);
  return camera;
}

/// The map of a section; nothing where it is missing or empty.
std::optional<YamlMap> section_of(const YamlMap& top, std::string_view key, std::span<const std::string_view> keys) {
  const std::optional<YamlField> section = top.find(key);
  if (!section || section->node().is_null()) return std::nullopt;
  return YamlMap(*section, keys, std::string(key));
}

/// The settings, which stand in `settings` or in `scene`, each once.
class Settings {
 public:
  Settings(const std::optional<YamlMap>& settings, const std::optional<YamlMap>& scene)
      : settings_(settings), scene_(scene) {}

  std::optional<YamlField> find(std::string_view key) const {
    const std::optional<YamlField> one = find_in(settings_, key), two = find_in(scene_, key);
    if (one && two) refuse_both(settings_->key_node(key), scene_->key_node(key));
    return one ? one : two;
  }

  YamlNode key_node(std::string_view key) const {
    return (find_in(settings_, key) ? settings_ : scene_)->key_node(key);
  }

 private:
  static std::optional<YamlField> find_in(const std::optional<YamlMap>& map, std::string_view key) {
    return map ? map->find(key) : std::nullopt;
  }

  const std::optional<YamlMap>& settings_;
  const std::optional<YamlMap>& scene_;
};

void read_settings(const Settings& settings, SceneDescription& scene, Notes& notes) {
  Background& background = scene.background;
  if (const auto field = settings.find("background_color")) background.color = field->single_vector(kAtLeastZero);
  if (const auto field = settings.find("background_intensity")) background.intensity = field->single(kAtLeastZero);
  if (const auto field = settings.find("ambient_light")) background.ambient = field->single(kAtLeastZero);
  if (const auto field = settings.find("adaptive_sampling"); field && field->boolean()) {
    notes.add("adaptive_sampling has no effect yet: all pixels get equal samples", field->place());
  }
  const std::optional<YamlField> structure = settings.find("structure"), use_bvh = settings.find("use_bvh");
  if (structure) {
    scene.structure = structure->text();
    scene.structure_place = structure->place();
  }
  if (!use_bvh || use_bvh->boolean()) return;
  if (structure) {
    refuse_both(settings.key_node("use_bvh"), settings.key_node("structure"), "use_bvh: false means brute_force");
  }
  scene.structure = "brute_force";
  scene.structure_place = use_bvh->place();
}

/// A scalar, which may be empty.
std::string free_text(const YamlField& field) {
  if (field.node().kind() != YamlKind::scalar) field.fail_type("a text");
  return std::string(field.node().text());
}

}  // namespace

void read_yaml_settings(const YamlMap& top, SceneDescription& scene, Notes& notes) {
  const std::optional<YamlMap> settings = section_of(top, "settings", kSettingsKeys);
  const std::optional<YamlMap> block = section_of(top, "scene", kSceneKeys);
  std::optional<YamlField> camera = top.find("camera");
  if (block) {
    if (const auto field = block->find("name")) scene.name = free_text(*field);
    if (const auto field = block->find("description")) scene.description = free_text(*field);
    if (const auto field = block->find("camera")) {
      if (camera) refuse_both(top.key_node("camera"), block->key_node("camera"));
      camera = field;
    }
  }
  scene.camera = read_camera(camera);
  read_settings(Settings(settings, block), scene, notes);
}

}  // namespace kerf
