// The smallest program: two triangles, split and put into a tree, and the first thing that a ray hits.

#include <cstdio>
#include <vector>

#include "kerf/scene/scene.h"

int main() {
  const std::vector<kerf::Vec3f> vertices = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}};
  const std::vector<kerf::TriangleCorners> triangles = {{0, 1, 2}, {0, 2, 3}};
  kerf::Scene scene;
  scene.add(kerf::TriangleMesh{vertices, triangles});
  scene.build({.structure = "early_split(budget=1.5)+binned_sah"});
  const kerf::Hit hit = scene.closest_hit({.origin = {1, 3, 5}, .direction = {0, 0, -1}});
  std::printf("triangle %u at t = %g, u = %g, v = %g\n", hit.primitive, hit.t, hit.u, hit.v);
}
