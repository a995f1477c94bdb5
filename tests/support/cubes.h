#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "kerf/references/reference.h"
#include "tests/support/random.h"

namespace kerf::test {

/// The box of a cube at a point.
inline Reference cube_at(Vec3f p, uint32_t primitive, float size = 0.5F) {
  return {p, 0, p + Vec3f{size, size, size}, primitive};
}

template <class T>
void shuffle(std::vector<T>& values, uint64_t seed) {
  Random random(seed);
  for (size_t i = values.size(); i > 1; --i) std::swap(values[i - 1], values[random.below(static_cast<uint32_t>(i))]);
}

}  // namespace kerf::test
