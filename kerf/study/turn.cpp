#include "kerf/study/turn.h"

#include <string>

#include "kerf/base/error.h"
#include "kerf/base/nearest_word.h"

namespace kerf {
namespace {

constexpr std::string_view kNames[] = {"straight", "x", "y", "z", "xyz"};
constexpr double kDegrees = 30;

}  // namespace

std::span<const std::string_view> turn_names() { return kNames; }

Transform turn_by_name(std::string_view name) {
  const Transform x = rotation(kX, kDegrees), y = rotation(kY, kDegrees), z = rotation(kZ, kDegrees);
  if (name == "straight") return {};
  if (name == "x") return x;
  if (name == "y") return y;
  if (name == "z") return z;
  if (name == "xyz") return then(then(x, y), z);
  throw Error(ErrorCode::invalid_option, "turn", "unknown turn '" + std::string(name) + "'" + suggestion(name, kNames));
}

Camera turned(const Camera& camera, const Transform& turn) {
  return {turn.point(camera.eye), turn.point(camera.look_at), turn.vector(camera.up), camera.fov};
}

Mesh turned(Mesh mesh, const Transform& turn) {
  for (Vec3f& vertex : mesh.vertices) vertex = to_float(turn.point(to_double(vertex)));
  for (Vec3f& normal : mesh.normals) normal = to_float(turn.vector(to_double(normal)));
  return mesh;
}

SceneDescription turned(SceneDescription scene, const Transform& turn) {
  for (SceneObject& object : scene.objects) {
    if (auto* mesh = std::get_if<Mesh>(&object.shape)) {
      *mesh = turned(std::move(*mesh), turn);
    } else if (auto* sphere = std::get_if<Sphere>(&object.shape)) {
      sphere->center = to_float(turn.point(to_double(sphere->center)));
    } else {
      auto& shape = std::get<Parallelogram>(object.shape);
      shape.corner = to_float(turn.point(to_double(shape.corner)));
      shape.u = to_float(turn.vector(to_double(shape.u)));
      shape.v = to_float(turn.vector(to_double(shape.v)));
    }
  }
  if (scene.camera) scene.camera = turned(*scene.camera, turn);
  return scene;
}

Transform axes_exchanged() { return {{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}}, {}}; }

SceneDescription scaled(SceneDescription scene, double factor) {
  const auto scale = [&](Vec3f& v) { v = to_float(to_double(v) * factor); };
  for (SceneObject& object : scene.objects) {
    if (auto* mesh = std::get_if<Mesh>(&object.shape)) {
      for (Vec3f& vertex : mesh->vertices) scale(vertex);
    } else if (auto* sphere = std::get_if<Sphere>(&object.shape)) {
      scale(sphere->center);
      sphere->radius = static_cast<float>(sphere->radius * factor);
    } else {
      auto& shape = std::get<Parallelogram>(object.shape);
      scale(shape.corner);
      scale(shape.u);
      scale(shape.v);
    }
  }
  if (scene.camera) {
    scene.camera->eye = scene.camera->eye * factor;
    scene.camera->look_at = scene.camera->look_at * factor;
  }
  return scene;
}

}  // namespace kerf
