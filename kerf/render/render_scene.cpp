#include "kerf/render/render_scene.h"

#include <cmath>
#include <utility>

#include "kerf/base/error.h"
#include "kerf/render/camera.h"
#include "kerf/render/color.h"
#include "kerf/render/frame.h"
#include "kerf/render/texture_lookup.h"

namespace kerf {
namespace {

TriangleMesh view_of(const Mesh& mesh) { return {std::span(mesh.vertices), std::span(mesh.triangles)}; }

Geometry geometry_of(const SceneObject& object) {
  const uint32_t mask = object.visible ? ~0U : ~kCameraMask;
  if (const auto* mesh = std::get_if<Mesh>(&object.shape)) return {view_of(*mesh), mask};
  if (const auto* sphere = std::get_if<Sphere>(&object.shape)) return {Strided<Sphere>(sphere, 1), mask};
  return {Strided<Parallelogram>(std::get_if<Parallelogram>(&object.shape), 1), mask};
}

/// The first object with a primitive that a scene refuses.
const SceneObject* find_invalid(const std::vector<SceneObject>& objects) {
  for (const SceneObject& object : objects) {
    const Geometry geometry = geometry_of(object);
    for (size_t i = 0; i < primitive_count(geometry); ++i) {
      if (find_defect(geometry, static_cast<uint32_t>(i)) != Defect::none) return &object;
    }
  }
  return nullptr;
}

/// Corner numbers must be in range where shading reads without looking: checked once here, whoever made the mesh.
bool has_right_numbers(const std::vector<Mesh::Corners>& corners, size_t triangles, size_t limit) {
  if (corners.empty()) return true;
  if (corners.size() != triangles) return false;
  for (const Mesh::Corners& corner : corners) {
    for (const uint32_t k : corner) {
      if (k >= limit && k != kNone) return false;
    }
  }
  return true;
}

void check(const SceneObject& object, size_t materials) {
  const auto refuse = [&](const char* sentence) { throw Error(ErrorCode::invalid_argument, object.place, sentence); };
  if (object.material >= materials) refuse("its material does not exist");
  const auto* mesh = std::get_if<Mesh>(&object.shape);
  if (mesh == nullptr) return;
  const size_t triangles = mesh->triangles.size();
  if (!mesh->materials.empty() && mesh->materials.size() != triangles) refuse("it has not one material a triangle");
  for (const uint32_t material : mesh->materials) {
    if (material >= materials) refuse("a triangle's material does not exist");
  }
  const bool plain_normals = mesh->normals.empty() || !mesh->normal_corners.empty();
  const bool plain_uvs = mesh->uvs.empty() || !mesh->uv_corners.empty();
  if ((!plain_normals && mesh->normals.size() != mesh->vertices.size()) ||
      !has_right_numbers(mesh->normal_corners, triangles, mesh->normals.size())) {
    refuse("a corner's normal does not exist");
  }
  if ((!plain_uvs && mesh->uvs.size() != mesh->vertices.size()) ||
      !has_right_numbers(mesh->uv_corners, triangles, mesh->uvs.size())) {
    refuse("a corner's texture coordinates do not exist");
  }
}

void check(const Material& material, const std::vector<Texture>& textures) {
  const auto refuse = [&](const char* sentence) {
    throw Error(ErrorCode::invalid_argument, "material '" + material.name + "'", sentence);
  };
  const auto is_share = [](float x) { return x >= 0 && x <= 1; };
  const bool is_radiance = material.type == MaterialType::constant;
  for (uint32_t c = 0; c < 3; ++c) {
    const float albedo = material.albedo[c], emission = material.emission[c];
    if (!(is_radiance ? albedo >= 0 && std::isfinite(albedo) : is_share(albedo))) refuse("its albedo is out of range");
    if (!(emission >= 0 && std::isfinite(emission))) refuse("its emission is out of range");
  }
  if (!is_share(material.roughness)) refuse("its roughness must lie between 0 and 1");
  if (!is_share(material.metallic)) refuse("its metallic must lie between 0 and 1");
  if (!is_share(material.transmission)) refuse("its transmission must lie between 0 and 1");
  if (!(material.refractive_index >= 1e-3F && material.refractive_index <= 1e3F)) {
    refuse("its refractive index must lie between 0.001 and 1000");
  }
  if (material.albedo_texture == kNoTexture) return;
  if (material.albedo_texture >= textures.size()) refuse("its texture does not exist");
  const Texture& texture = textures[material.albedo_texture];
  if (texture.rgb.size() != size_t{texture.width} * texture.height * 3)
    refuse("its texture has not three bytes a pixel");
}

/// The numbers that a triangle's corners have among normals or texture coordinates; false if one has none.
bool corner_numbers(const std::vector<Mesh::Corners>& corners, const Mesh& mesh, uint32_t triangle,
                    Mesh::Corners& out) {
  out = corners.empty() ? mesh.triangles[triangle] : corners[triangle];
  return out[0] != kNone && out[1] != kNone && out[2] != kNone;
}

Vec3f interpolated_normal(const Mesh& mesh, const Hit& hit, Vec3f flat) {
  Mesh::Corners k;
  if (mesh.normals.empty() || !corner_numbers(mesh.normal_corners, mesh, hit.primitive, k)) return flat;
  const auto unit = [&](uint32_t corner) { return normalized(to_double(mesh.normals[k[corner]])); };
  const Vec3d smooth = unit(0) * (1.0 - hit.u - hit.v) + unit(1) * double{hit.u} + unit(2) * double{hit.v};
  const double length = std::sqrt(dot(smooth, smooth));
  return length > 0 && std::isfinite(length) ? to_float(smooth / length) : flat;
}

std::array<float, 2> interpolated_uv(const Mesh& mesh, const Hit& hit) {
  Mesh::Corners k;
  if (mesh.uvs.empty() || !corner_numbers(mesh.uv_corners, mesh, hit.primitive, k)) return {0, 0};
  std::array<float, 2> uv;
  for (size_t i = 0; i < 2; ++i) {
    uv[i] = mesh.uvs[k[0]][i] * (1 - hit.u - hit.v) + mesh.uvs[k[1]][i] * hit.u + mesh.uvs[k[2]][i] * hit.v;
  }
  return uv;
}

}  // namespace

Scene build_scene(const SceneDescription& description, const BuildOptions& options) {
  Scene scene;
  for (const SceneObject& object : description.objects) scene.add(geometry_of(object));
  try {
    scene.build(options);
  } catch (const Error& error) {
    const SceneObject* invalid =
        error.code() == ErrorCode::invalid_geometry ? find_invalid(description.objects) : nullptr;
    if (invalid == nullptr) throw;
    throw Error(error.code(), invalid->place, error.what());
  }
  return scene;
}

RenderScene::RenderScene(SceneDescription description, const BuildOptions& options)
    : description_(std::move(description)) {
  if (description_.materials.empty()) description_.materials.emplace_back();
  for (const SceneObject& object : description_.objects) {
    check(object, description_.materials.size());
  }
  for (const Material& material : description_.materials) check(material, description_.textures);
  const Background& background = description_.background;
  background_ = background.color * background.intensity;
  background_with_ambient_ = background_ + Vec3f{1, 1, 1} * background.ambient;
  scene_ = build_scene(description_, options);
}

const Material& RenderScene::material(uint32_t object, uint32_t primitive) const {
  const SceneObject& from = description_.objects[object];
  const auto* mesh = std::get_if<Mesh>(&from.shape);
  const bool has_own = mesh != nullptr && !mesh->materials.empty();
  return description_.materials[has_own ? mesh->materials[primitive] : from.material];
}

Surface RenderScene::surface(const Ray& ray, const Hit& hit) const {
  const SceneObject& object = description_.objects[hit.geometry];
  Surface surface;
  surface.material = &material(hit.geometry, hit.primitive);
  surface.albedo = surface.material->albedo;
  surface.point = hit_point(scene_.geometries()[hit.geometry], ray, hit);
  if (const auto* mesh = std::get_if<Mesh>(&object.shape)) {
    surface.geometric_normal = to_float(surface.point.normal);
    surface.shading_normal = interpolated_normal(*mesh, hit, surface.geometric_normal);
    if (dot(surface.shading_normal, surface.geometric_normal) < 0) {
      surface.geometric_normal = -surface.geometric_normal;
    }
    if (surface.material->albedo_texture != kNoTexture) {
      const Texture& texture = description_.textures[surface.material->albedo_texture];
      surface.albedo = scaled(surface.albedo, texture_color(texture, interpolated_uv(*mesh, hit)));
    }
    return surface;
  }
  surface.geometric_normal = surface.shading_normal = to_float(surface.point.normal);
  return surface;
}

}  // namespace kerf
