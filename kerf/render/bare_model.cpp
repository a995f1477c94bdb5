#include "kerf/render/bare_model.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "kerf/geometry/geometry.h"
#include "kerf/render/camera.h"
#include "kerf/render/color.h"
#include "kerf/render/frame.h"
#include "kerf/render/path_tracer.h"
#include "kerf/render/render_scene.h"

namespace kerf {
namespace {

Box3f sphere_bounds(const Sphere& sphere) { return primitive_bounds(Geometry{Strided<Sphere>(&sphere, 1)}, 0); }

void add_lamp(SceneDescription& scene, Vec3d center, double radius, Vec3f radiance) {
  if (!(largest(abs(center)) + radius < double{kMaxCoordinate})) return;  // then the sky must do
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
  add_lamp(scene, center + key * distance, 0.25 * distance, {10, 9.2F, 8});
  add_lamp(scene, center + fill * distance, 0.3 * distance, {0.7F, 0.8F, 1});
}

/// Lamps in the free space along the middle of the view, each half way up to what is above it.
void place_lamps_within(SceneDescription& scene, const Camera& camera, double size) {
  // A handful of rays do not pay for a tree.
  const Scene probe = build_scene(scene, {.structure = "brute_force", .skip_invalid = true});
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
    add_lamp(scene, below + up * (0.5 * height), 0.02 * depth, {1, 0.93F, 0.82F});
  }
}

/// The mean luminance of a small picture, its brightest tenth left out: lamps near a wall are not what a picture is of.
float typical_luminance(const RenderScene& scene, const Camera& camera, int threads) {
  PathTracerOptions options;
  options.width = 48;
  options.height = 32;
  options.samples = 8;
  options.threads = threads;
  const Image picture = render_paths(scene, camera, options).radiance;
  std::vector<float> all;
  for (size_t i = 0; i < picture.pixels.size(); i += 3) {
    all.push_back(luminance({picture.pixels[i], picture.pixels[i + 1], picture.pixels[i + 2]}));
  }
  std::sort(all.begin(), all.end());
  all.resize(all.size() * 9 / 10);
  return std::accumulate(all.begin(), all.end(), 0.0F) / static_cast<float>(all.size());
}

/// As light_from_outside, but as bright as a picture of the view needs: what a room swallows cannot be told beforehand.
void light_from_within(SceneDescription& scene, const Camera& camera, const BuildOptions& build, double size) {
  const Background sky = scene.background;
  const size_t first = scene.materials.size();
  place_lamps_within(scene, camera, size);
  scene.background = {{0, 0, 0}, 0, 0};
  RenderScene lit(std::move(scene), build);
  const float luminance = typical_luminance(lit, camera, build.threads);
  scene = lit.take_description();
  scene.background = sky;
  scene.background.intensity = 0.5F;  // of which a room sees the bright end only
  constexpr float kWanted = 0.25F;
  if (!(luminance > 0)) return;
  for (size_t i = first; i < scene.materials.size(); ++i) {
    scene.materials[i].emission = scene.materials[i].emission * (kWanted / luminance);
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

void add_light(SceneDescription& scene, const Camera& camera, const BuildOptions& build) {
  scene.background = {{0.62F, 0.76F, 0.95F}, 0.7F, 0};
  scene.is_lit = true;
  const Box3f bounds = bounds_of(scene);
  if (bounds.is_empty()) return;
  const Vec3d lower = to_double(bounds.lower), upper = to_double(bounds.upper), diagonal = upper - lower;
  const double size = std::sqrt(dot(diagonal, diagonal));
  if (!(size > 0)) return;
  const bool is_within = min(camera.eye, lower) == lower && max(camera.eye, upper) == upper;
  if (is_within) {
    light_from_within(scene, camera, build, size);
  } else {
    light_from_outside(scene, camera, (lower + upper) * 0.5, size);
  }
}

}  // namespace kerf
