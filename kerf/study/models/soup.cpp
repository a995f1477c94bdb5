// The soup: small triangles of all shapes without any order, in a cube.

#include <algorithm>
#include <cmath>

#include "kerf/study/models/loose_triangles.h"

namespace kerf {

MadeModel make_soup(uint64_t triangles, uint64_t seed) {
  // As large as the room that each has.
  const double size = 1 / std::cbrt(static_cast<double>(std::max<uint64_t>(triangles, 1)));
  return loose_triangles(triangles, seed, [size](ModelRandom& random) {
    const Vec3d center = random.point_between({0, 0, 0}, {1, 1, 1});
    std::array<Vec3d, 3> corners;
    for (Vec3d& corner : corners) corner = center + random.direction() * (size * random.between(0.2, 1.0));
    return corners;
  });
}

}  // namespace kerf
