// Uses an installed Kerf; the headers that were installed stand in all_headers.h.

#include <kerf/scene/scene.h>

#include <kerf/base/version.h>
#include <cstdio>
#include <vector>

#include "all_headers.h"
#ifdef WITH_RENDER
#include <kerf/io/ply.h>
#include <kerf/render/camera.h>
#endif

int main() {
  const std::vector<kerf::Vec3f> vertices = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}};
  const std::vector<kerf::TriangleCorners> triangles = {{0, 1, 2}, {0, 2, 3}};
  kerf::Scene scene;
  scene.add(kerf::TriangleMesh{vertices, triangles});
  scene.build({.structure = "early_split(budget=1.5)+binned_sah", .threads = 2});
  const kerf::Hit hit = scene.closest_hit({.origin = {1, 3, 5}, .direction = {0, 0, -1}});
#ifdef WITH_RENDER
  try {
    kerf::read_ply("");
    return 1;
  } catch (const kerf::Error&) {  // as it should: there is no such file
  }
#endif
  std::printf("kerf %s: triangle %u at %g\n", kerf::kVersion, hit.primitive, hit.t);
}
