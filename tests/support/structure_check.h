#pragma once

#include <optional>
#include <span>
#include <string>

#include "kerf/scene/scene.h"
#include "kerf/scene/structure.h"

namespace kerf::test {

/// What is wrong with a built structure, from outside, whatever its kind, the first that is met: nodes more than one
/// level below that before them, boxes of children outside their parent's, primitives of an area that no leaf has, and
/// points of primitives where no leaf that has them reaches. Points are a corner grid of each triangle and
/// parallelogram, and those of spheres along the axes.
std::optional<std::string> find_outer_fault(const Structure& structure, std::span<const Geometry> geometries);
std::optional<std::string> find_outer_fault(const Scene& scene);

}  // namespace kerf::test
