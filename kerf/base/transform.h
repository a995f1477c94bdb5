#pragma once

#include <cmath>
#include <numbers>

#include "kerf/base/vec3.h"

namespace kerf {

/// A linear map and a translation, in double: p -> columns * p + translation.
struct Transform {
  Vec3d column[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  Vec3d translation;

  constexpr Vec3d vector(Vec3d v) const { return column[0] * v.x + column[1] * v.y + column[2] * v.z; }
  constexpr Vec3d point(Vec3d p) const { return vector(p) + translation; }
};

/// First `first`, then `second`.
constexpr Transform then(const Transform& first, const Transform& second) {
  Transform both;
  for (int i = 0; i < 3; ++i) both.column[i] = second.vector(first.column[i]);
  both.translation = second.point(first.translation);
  return both;
}

/// Turns by `degrees` about a coordinate axis, counter-clockwise seen from its positive end.
inline Transform rotation(uint32_t axis, double degrees) {
  const double angle = degrees * std::numbers::pi / 180;
  const double c = std::cos(angle), s = std::sin(angle);
  const uint32_t a = (axis + 1) % 3, b = (axis + 2) % 3;
  Transform turn;
  turn.column[a][a] = c;
  turn.column[a][b] = s;
  turn.column[b][a] = -s;
  turn.column[b][b] = c;
  return turn;
}

}  // namespace kerf
