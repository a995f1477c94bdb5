#include "kerf/render/picture_rays.h"

#include "kerf/render/camera.h"
#include "kerf/render/frame.h"
#include "kerf/render/sampler.h"
#include "kerf/render/surface.h"

namespace kerf {
namespace {

/// From a hit to the side that the ray came from.
Ray diffuse_ray(const Scene& scene, const Ray& from, const Hit& hit, uint32_t pixel) {
  const SurfacePoint point = hit_point(scene.geometries()[hit.geometry], from, hit);
  Vec3f normal = to_float(point.normal);
  if (dot(normal, from.direction) > 0) normal = -normal;
  Sampler sampler(1, pixel, 0);
  Ray ray;
  ray.direction = Frame(normal).to_world(cosine_direction(sampler.next_pair()));
  ray.origin = offset_origin(point, ray.direction);
  ray.mask = kIndirectMask;
  return ray;
}

}  // namespace

PictureRays picture_rays(const Scene& scene, const Camera& camera, uint32_t width, uint32_t height) {
  const CameraRays pixel(camera, width, height);
  PictureRays picture;
  picture.primary = size_t{width} * height;
  picture.rays.resize(picture.primary);
  std::vector<Hit> hits(picture.primary);
  for (size_t i = 0; i < picture.primary; ++i) {
    picture.rays[i] = pixel.center(static_cast<uint32_t>(i % width), static_cast<uint32_t>(i / width));
  }
  scene.closest_hit(picture.rays, hits);
  for (size_t i = 0; i < picture.primary; ++i) {
    if (!hits[i]) continue;
    picture.rays.push_back(diffuse_ray(scene, Ray(picture.rays[i]), hits[i], static_cast<uint32_t>(i)));
  }
  return picture;
}

}  // namespace kerf
