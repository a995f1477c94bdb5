// A scene made in code, path-traced and written as a PNG: a glass ball on a floor under a square light.

#include <cstdio>

#include "kerf/io/image_write.h"
#include "kerf/render/path_tracer.h"

namespace {

uint32_t add_material(kerf::SceneDescription& scene, kerf::MaterialType type, kerf::Vec3f albedo,
                      kerf::Vec3f emission = {}) {
  kerf::Material material;
  material.type = type;
  material.albedo = albedo;
  material.emission = emission;
  scene.materials.push_back(material);
  return static_cast<uint32_t>(scene.materials.size() - 1);
}

}  // namespace

int main(int argc, char** argv) {
  kerf::SceneDescription scene;
  scene.background = {{0.3F, 0.4F, 0.5F}, 1, 0};
  const uint32_t floor = add_material(scene, kerf::MaterialType::lambertian, {0.7F, 0.6F, 0.5F});
  const uint32_t glass = add_material(scene, kerf::MaterialType::glass, {1, 1, 1});
  const uint32_t light = add_material(scene, kerf::MaterialType::light, {}, {8, 7, 6});
  scene.objects.push_back({kerf::Parallelogram{{-5, 0, -5}, {0, 0, 10}, {10, 0, 0}}, floor});
  scene.objects.push_back({kerf::Sphere{{0, 1, 0}, 1}, glass});
  scene.objects.push_back({kerf::Parallelogram{{-1, 4, -1}, {2, 0, 0}, {0, 0, 2}}, light});

  const kerf::RenderScene built(std::move(scene), {.structure = "early_split(budget=1.5)+binned_sah"});
  const kerf::Camera camera{.eye = {0, 2, 5}, .look_at = {0, 0.8, 0}, .fov = 40};
  const kerf::PathTracerResult result = kerf::render_paths(built, camera, {.width = 90, .height = 60, .samples = 16});
  kerf::write_png(argc > 1 ? argv[1] : "/dev/null", kerf::srgb_picture(result.radiance));
  std::printf("%llu paths\n", static_cast<unsigned long long>(result.paths));
}
