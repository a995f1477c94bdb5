#include "kerf/render/bare_model.h"

#include <algorithm>
#include <cmath>

#include "kerf/geometry/geometry.h"
#include "kerf/render/camera.h"
#include "kerf/render/frame.h"
#include "kerf/render/render_scene.h"

namespace kerf {
namespace {

Box3f sphere_bounds(const Sphere& sphere) { return primitive_bounds(Geometry{Strided<Sphere>(&sphere, 1)}, 0); }

void add_lamp(SceneDescription& scene, Vec3d center, double radius, Vec3f radiance) {
  Material light;
  light.name = "added light";
  light.type = MaterialType::light;
  light.emission = radiance;
  scene.materials.push_back(light);
  const Sphere sphere{to_float(center), static_cast<float>(radius)};
  scene.objects.push_back({sphere, static_cast<uint32_t>(scene.materials.size() - 1), false, "added light"});
}

/// A warm one from the upper left and a weak one from the right, far enough to light all of the model alike.
void light_from_outside(SceneDescription& scene, const Camera& camera, Vec3d center, double size) {
  const Vec3d view = normalized(camera.look_at - camera.eye), up = normalized(camera.up);
  const Vec3d right = normalized(cross(view, up));
  const Vec3d key = normalized(up * 1.1 - right * 0.9 - view * 0.6), fill = normalized(up * 0.3 + right - view * 0.7);
  const double distance = 3 * size;
  add_lamp(scene, center + key * distance, 0.25 * distance, {22, 20, 17});
  add_lamp(scene, center + fill * distance, 0.3 * distance, {2.0F, 2.3F, 2.8F});
}

/// Lamps in the free space along the middle of the view, each half way up to what is above it.
void light_from_within(SceneDescription& scene, const Camera& camera, double size) {
  // A handful of rays do not pay for a tree.
  Scene probe;
  for (const SceneObject& object : scene.objects) {
    const auto* mesh = std::get_if<Mesh>(&object.shape);
    if (mesh == nullptr) continue;
    probe.add(TriangleMesh{std::span(mesh->vertices), std::span(mesh->triangles)});
  }
  probe.build({.structure = "brute_force", .skip_invalid = true});
  const auto free_way = [&](Vec3d from, Vec3d direction) {
    Ray ray;
    ray.origin = to_float(from);
    ray.direction = to_float(direction);
    const Hit hit = probe.closest_hit(ray);
    return std::min(hit ? double{hit.t} : size, size);
  };
  const Vec3d view = normalized(camera.look_at - camera.eye), up = normalized(camera.up);
  const double depth = free_way(camera.eye, view);
  for (const double share : {0.05, 0.4, 0.75}) {
    const Vec3d below = camera.eye + view * (depth * share);
    const double height = std::min(free_way(below, up), depth);
    const Vec3d center = below + up * (0.5 * height);
    const double radius = 0.02 * depth;
    // As bright as lights a white wall with radiance 1 at a quarter of the depth.
    const double reach = 0.25 * depth / radius;
    const auto radiance = static_cast<float>(reach * reach);
    add_lamp(scene, center, radius, {radiance, 0.93F * radiance, 0.82F * radiance});
  }
}

}  // namespace

Box3f bounds_of(const SceneDescription& scene) {
  Box3f bounds;
  for (const SceneObject& object : scene.objects) {
    if (const auto* mesh = std::get_if<Mesh>(&object.shape)) {
      for (const Mesh::Corners& corners : mesh->triangles) {
        for (const uint32_t k : corners) {
          if (k < mesh->vertices.size() && is_coordinate(mesh->vertices[k])) bounds.extend(mesh->vertices[k]);
        }
      }
    } else if (const auto* sphere = std::get_if<Sphere>(&object.shape)) {
      bounds.extend(sphere_bounds(*sphere));
    } else {
      for (const Vec3d& corner : std::get_if<Parallelogram>(&object.shape)->corners()) bounds.extend(to_float(corner));
    }
  }
  return bounds;
}

void add_light(SceneDescription& scene, const Camera& camera) {
  scene.background = {{0.75F, 0.85F, 1.0F}, 0.9F, 0};
  scene.is_lit = true;
  const Box3f bounds = bounds_of(scene);
  if (bounds.is_empty()) return;
  const Vec3d lower = to_double(bounds.lower), upper = to_double(bounds.upper), diagonal = upper - lower;
  const double size = std::sqrt(dot(diagonal, diagonal));
  if (!(size > 0)) return;
  const bool is_within = min(camera.eye, lower) == lower && max(camera.eye, upper) == upper;
  if (is_within) {
    light_from_within(scene, camera, size);
  } else {
    light_from_outside(scene, camera, (lower + upper) * 0.5, size);
  }
}

}  // namespace kerf
