#include "kerf/io/yaml/yaml_models.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "kerf/base/error.h"

namespace kerf {
namespace {

/// Scales and moves vertices in double. Those that were in range must stay so.
void transform_vertices(std::vector<Vec3f>& vertices, Vec3d scale, Vec3d position, const std::string& place) {
  if (scale == Vec3d{1, 1, 1} && position == Vec3d{}) return;
  for (size_t i = 0; i < vertices.size(); ++i) {
    const Vec3f before = vertices[i];
    const Vec3d p{before.x * scale.x + position.x, before.y * scale.y + position.y, before.z * scale.z + position.z};
    vertices[i] = to_float(p);
    if (is_coordinate(before) && !is_coordinate(vertices[i])) {
      throw Error(ErrorCode::file, place, fmt::format("scale and position move vertex {} beyond 2^120 (1.3e36)", i));
    }
  }
}

/// Turns normals as their surface turns: by the inverse of the scale, which is its own transpose. They are of unit
/// length afterwards, or large scales would leave the range of float; what has no length stays as it is.
void transform_normals(std::vector<Vec3f>& normals, Vec3d scale) {
  if (scale.x == scale.y && scale.y == scale.z && scale.x > 0) return;
  // Of size 1 at the most, so that no square below leaves the range of double.
  const double least = std::min({std::abs(scale.x), std::abs(scale.y), std::abs(scale.z)});
  const Vec3d factor{least / scale.x, least / scale.y, least / scale.z};
  for (Vec3f& normal : normals) {
    const Vec3d n{normal.x * factor.x, normal.y * factor.y, normal.z * factor.z};
    const double length = std::sqrt(dot(n, n));
    if (length > 0 && std::isfinite(length)) normal = to_float(n / length);
  }
}

void turn_around(std::vector<Mesh::Corners>& corners) {
  for (Mesh::Corners& corner : corners) std::swap(corner[1], corner[2]);
}

void transform(Mesh& mesh, Vec3d scale, Vec3d position, const std::string& place) {
  transform_vertices(mesh.vertices, scale, position, place);
  transform_normals(mesh.normals, scale);
  const int negative = (scale.x < 0 ? 1 : 0) + (scale.y < 0 ? 1 : 0) + (scale.z < 0 ? 1 : 0);
  if (negative % 2 == 0) return;
  turn_around(mesh.triangles);
  turn_around(mesh.normal_corners);
  turn_around(mesh.uv_corners);
}

}  // namespace

void YamlModels::place(size_t object, const YamlField& file, Vec3d scale, Vec3d position, bool has_material) {
  const std::string path = (std::filesystem::path(folder_) / file.text()).lexically_normal().string();
  placements_.push_back({object, path, file.place(), scale, position, has_material});
  ++loaded_[path].placements_left;
}

void YamlModels::load(SceneDescription& scene) {
  for (const Placement& placement : placements_) {
    Loaded& loaded = loaded_[placement.path];
    if (!loaded.model) read(placement, loaded, scene);
    // The last one to use a mesh takes it: a scene of one large model never holds it twice.
    const bool is_last = --loaded.placements_left == 0;
    Mesh mesh = is_last ? std::move(loaded.model->mesh) : loaded.model->mesh;
    SceneObject& object = scene.objects[placement.object];
    if (placement.has_material) {
      mesh.materials.clear();
    } else {
      if (!loaded.first_material) loaded.first_material = append_materials(*loaded.model, scene);
      object.material = *loaded.first_material;
      for (uint32_t& material : mesh.materials) material += *loaded.first_material;
    }
    transform(mesh, placement.scale, placement.position, placement.place);
    object.shape = std::move(mesh);
    if (is_last) loaded.model.reset();
  }
}

void YamlModels::read(const Placement& placement, Loaded& loaded, SceneDescription& scene) {
  try {
    loaded.model = read_model(placement.path);
  } catch (const Error& error) {
    throw Error(ErrorCode::file, placement.place, error.what());
  }
  if (loaded.model->mesh.triangles.empty()) {
    throw Error(ErrorCode::file, placement.place, placement.path + " has no face, so nothing to see");
  }
  for (const std::string& note : loaded.model->notes) {
    scene.notes.push_back(fmt::format("{}: {}: {}", placement.place, placement.path, note));
  }
}

/// Returns the number of the first one.
uint32_t YamlModels::append_materials(Model& model, SceneDescription& scene) {
  const auto first = static_cast<uint32_t>(scene.materials.size());
  if (model.materials.empty()) {
    if (!default_material_) {
      default_material_ = first;
      scene.materials.emplace_back();
    }
    return *default_material_;
  }
  const auto first_texture = static_cast<uint32_t>(scene.textures.size());
  for (Material& material : model.materials) {
    if (material.albedo_texture != kNoTexture) material.albedo_texture += first_texture;
    scene.materials.push_back(std::move(material));
  }
  for (Texture& texture : model.textures) scene.textures.push_back(std::move(texture));
  return first;
}

}  // namespace kerf
