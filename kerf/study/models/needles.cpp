// Needles: long thin triangles in all directions, in a cube.

#include <algorithm>
#include <cmath>

#include "kerf/study/models/loose_triangles.h"

namespace kerf {

MadeModel make_needles(uint64_t triangles, uint64_t seed) {
  // Lengths in units of the room that each has, so that as many meet at any number.
  constexpr double kLeastLength = 1, kMostLength = 8, kLeastSlenderness = 100, kMostSlenderness = 1000;
  const double room = 1 / std::cbrt(static_cast<double>(std::max<uint64_t>(triangles, 1)));
  return loose_triangles(triangles, seed, [room](ModelRandom& random) {
    const Vec3d center = random.point_between({0, 0, 0}, {1, 1, 1}), along = random.direction();
    const double length = room * random.between(kLeastLength, kMostLength);
    const double width = length / random.between_octaves(kLeastSlenderness, kMostSlenderness);
    const double at = length * random.between(-0.5, 0.5);
    return std::array<Vec3d, 3>{center - along * (length / 2), center + along * (length / 2),
                                center + along * at + random.direction() * width};
  });
}

}  // namespace kerf
