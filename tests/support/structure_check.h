#pragma once

#include <optional>
#include <string>

#include "kerf/scene/scene.h"

namespace kerf::test {

/// What is wrong with a built structure, from outside, whatever its kind: boxes of children outside their parent's,
/// primitives of an area that no leaf has, and points of primitives where no leaf that has them reaches. Points are a
/// corner grid of each triangle and parallelogram, and those of spheres along the axes.
std::optional<std::string> find_outer_fault(const Scene& scene);

}  // namespace kerf::test
