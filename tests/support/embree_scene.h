#pragma once

#include <memory>

#include "kerf/geometry/hit.h"
#include "kerf/geometry/ray.h"
#include "kerf/io/mesh.h"

namespace kerf::test {

/// A mesh in Embree's robust scene: the oracle. Not exact: its t may be off, and it reports false hits on grazing
/// slivers; a difference is decided in higher precision.
class EmbreeScene {
 public:
  explicit EmbreeScene(const Mesh& mesh);
  ~EmbreeScene();

  Hit closest_hit(const Ray& ray) const;

 private:
  struct Handles;
  std::unique_ptr<Handles> handles_;
};

}  // namespace kerf::test
