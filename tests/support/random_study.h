#pragma once

#include <utility>

#include "kerf/study/study.h"
#include "tests/support/random_scene.h"

namespace kerf::test {

/// Random triangles and a camera that looks at them.
inline StudyScene random_study(size_t triangles) {
  const RandomTriangles random(triangles);
  Mesh mesh;
  mesh.vertices = random.vertices;
  for (const TriangleCorners& corners : random.triangles) mesh.triangles.push_back(corners);
  StudyScene scene;
  scene.name = "random";
  scene.description.is_lit = false;
  scene.description.materials.emplace_back();
  scene.description.objects.push_back({std::move(mesh), 0, true, "random"});
  scene.camera = {.eye = {0, 0, 40}, .look_at = {0, 0, 0}, .up = {0, 1, 0}, .fov = 40};
  return scene;
}

}  // namespace kerf::test
