#include "kerf/study/study_rays.h"

#include <algorithm>
#include <cmath>

#include "kerf/render/bare_model.h"
#include "kerf/render/camera.h"
#include "kerf/render/frame.h"
#include "kerf/render/lights.h"
#include "kerf/render/sampler.h"

namespace kerf {
namespace {

constexpr double kOcclusionReach = 0.1;  // of the diagonal of the scene's box

constexpr RayKindEntry kKinds[] = {
    {RayKind::primary, "primary", "from the camera through each pixel", false},
    {RayKind::shadow, "shadow", "from what those hit to a point on a light, or into the sky where there is none", true},
    {RayKind::ambient_occlusion, "ambient_occlusion",
     "from what those hit in a random direction, a tenth of the scene's diagonal long", true},
    {RayKind::diffuse, "diffuse", "from what those hit in a random direction, as far as it goes", false},
};

/// What a ray of a picture hit.
struct Place {
  uint32_t pixel;
  SurfacePoint point;
  Vec3f normal;  ///< on the side that the ray came from
};

/// The scene that rays start in, with lights where they are asked for.
RenderScene starting_scene(const SceneDescription& scene, const Camera& camera, bool with_light, bool skip_invalid,
                           const WorkLimit& limit) {
  // Rays pay for the tree; any other one gives the same hits.
  const BuildOptions build{
      .structure = "early_split(budget=1.5)+binned_sah", .skip_invalid = skip_invalid, .limit = limit};
  SceneDescription copy = scene;
  if (copy.materials.empty()) copy.materials.emplace_back();
  if (with_light && !copy.is_lit) add_light(copy, camera, build);
  return RenderScene(std::move(copy), build);
}

std::vector<Place> places_of(const RenderScene& scene, const std::vector<Ray>& rays) {
  std::vector<Hit> hits(rays.size());
  scene.scene().closest_hit(rays, hits);
  std::vector<Place> places;
  for (size_t i = 0; i < rays.size(); ++i) {
    if (!hits[i]) continue;
    const Surface surface = scene.surface(rays[i], hits[i]);
    const bool is_behind = dot(surface.geometric_normal, rays[i].direction) > 0;
    places.push_back(
        {static_cast<uint32_t>(i), surface.point, is_behind ? -surface.geometric_normal : surface.geometric_normal});
  }
  return places;
}

Ray leaving(const Place& place, Vec3f direction) {
  Ray ray;
  ray.origin = offset_origin(place.point, direction);
  ray.direction = direction;
  ray.mask = kIndirectMask;
  return ray;
}

Ray random_ray(const Place& place, Sampler& sampler) {
  return leaving(place, Frame(place.normal).to_world(cosine_direction(sampler.next_pair())));
}

/// To a point on a light that lies on the seen side of the surface; a random ray where none does.
Ray shadow_ray(const Place& place, const Lights& lights, Sampler& sampler) {
  LightSample light;
  const float choice = sampler.next();
  const bool is_found = lights.size() > 0 && lights.sample(place.point.position, choice, sampler.next_pair(), light) &&
                        dot(light.direction, place.normal) > 0;
  if (!is_found) return random_ray(place, sampler);
  Ray ray = leaving(place, light.direction);
  // Ends before the light, which is part of some scenes.
  const Vec3f target = offset_origin(light.point, -light.direction);
  ray.direction = target - ray.origin;
  ray.t_max = 1;
  return ray;
}

}  // namespace

std::span<const RayKindEntry> ray_kinds() { return kKinds; }

std::vector<StudyRays> make_study_rays(const SceneDescription& scene, const Camera& camera, uint32_t width,
                                       uint32_t height, std::span<const RayKind> kinds, bool skip_invalid,
                                       const WorkLimit& limit) {
  const bool with_light = std::find(kinds.begin(), kinds.end(), RayKind::shadow) != kinds.end();
  const CameraRays pixel(camera, width, height);
  std::vector<Ray> primary;
  primary.reserve(size_t{width} * height);
  for (uint32_t y = 0; y < height; ++y) {
    for (uint32_t x = 0; x < width; ++x) primary.push_back(pixel.center(x, y));
  }
  const RenderScene start = starting_scene(scene, camera, with_light, skip_invalid, limit);
  const Lights lights(start);
  const Vec3d diagonal = to_double(bounds_of(scene).extent());  // without the lights that were added
  const auto reach = static_cast<float>(kOcclusionReach * std::sqrt(dot(diagonal, diagonal)));
  std::vector<Place> places;
  if (std::any_of(kinds.begin(), kinds.end(), [](RayKind kind) { return kind != RayKind::primary; })) {
    places = places_of(start, primary);
  }
  std::vector<StudyRays> all;
  for (const RayKind kind : kinds) {
    const RayKindEntry& entry = kKinds[static_cast<size_t>(kind)];
    StudyRays rays{std::string(entry.name), entry.any_hit, {}};
    if (kind == RayKind::primary) {
      rays.rays = primary;
    } else {
      for (const Place& place : places) {
        Sampler sampler(static_cast<uint32_t>(kind), place.pixel, 0);
        Ray ray = kind == RayKind::shadow ? shadow_ray(place, lights, sampler) : random_ray(place, sampler);
        if (kind == RayKind::ambient_occlusion) ray.t_max = reach;
        rays.rays.push_back(ray);
      }
    }
    all.push_back(std::move(rays));
  }
  return all;
}

}  // namespace kerf
