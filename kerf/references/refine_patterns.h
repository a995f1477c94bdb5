#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "kerf/base/vec3.h"

namespace kerf {

/// A corner of a small triangle.
struct RefinedCorner {
  Vec3d position;
  double u = 0, v = 0;  ///< the weights of the original's second and third corner, exact
  double error = 0;     ///< of the position along each axis, at most; 0 where all midpoints were exact
};

/// The middle of a side: the same from both of its ends, so from both triangles at it.
inline RefinedCorner midpoint(const RefinedCorner& p, const RefinedCorner& q) {
  RefinedCorner m{{}, 0.5 * (p.u + q.u), 0.5 * (p.v + q.v), p.error > q.error ? p.error : q.error};
  for (uint32_t axis = 0; axis < 3; ++axis) {
    const double a = p.position[axis], b = q.position[axis], sum = a + b;
    // What the sum lost to rounding, exactly (Knuth: The Art of Computer Programming 2, 4.2.2); halving loses nothing.
    const double b_seen = sum - a, lost = (a - (sum - b_seen)) + (b - b_seen);
    m.position[axis] = 0.5 * sum;
    m.error += std::abs(lost);
  }
  return m;
}

/// How often a size must be divided by `factor` until it is at most `limit`; kMostLevels at most, which are more pieces
/// than can be counted.
inline constexpr uint32_t kMostLevels = 60;
inline uint32_t levels_above(double size, double limit, double factor) {
  uint32_t levels = 0;
  for (; size > limit && levels < kMostLevels; size /= factor) ++levels;
  return levels;
}

inline double distance(const RefinedCorner& p, const RefinedCorner& q) {
  const Vec3d d = q.position - p.position;
  return std::sqrt(dot(d, d));
}

/// Cuts a triangle by the levels of its sides: a side of level n is halved n times, whatever becomes of the rest, so
/// two triangles that give their common side the same level meet without a T-junction. A triangle with three sides to
/// be halved becomes four, one with two becomes three, one with one becomes two. Calls emit(corners) for each small
/// triangle; it returns false to stop.
template <class Emit>
class TriangleCutter {
 public:
  using Corners = std::array<RefinedCorner, 3>;
  using Levels = std::array<uint32_t, 3>;  ///< of the sides from corner 0 to 1, 1 to 2 and 2 to 0

  /// Sides that appear inside are halved until they are at most `longest` (infinite: never), at least `inner` - 1 times
  /// for those of the first cut, one less for each cut further in.
  TriangleCutter(double longest, Emit& emit) : longest_(longest), emit_(emit) {}

  /// False where emit() stopped it.
  bool cut(const Corners& c, const Levels& level, uint32_t inner) {
    const int marks = (level[0] > 0) + (level[1] > 0) + (level[2] > 0);
    if (marks == 0) return emit_(c);
    if (marks == 3) return cut_in_four(c, level, inner > 0 ? inner - 1 : 0);
    const bool wanted = marks == 1;  // turn it so that the side that differs comes first
    const uint32_t first = (level[0] > 0) == wanted ? 0 : (level[1] > 0) == wanted ? 1 : 2;
    const uint32_t second = (first + 1) % 3, third = (first + 2) % 3;
    const Corners turned{c[first], c[second], c[third]};
    const Levels levels{level[first], level[second], level[third]};
    return marks == 1 ? cut_in_two(turned, levels) : cut_in_three(turned, levels);
  }

 private:
  uint32_t level_inside(const RefinedCorner& p, const RefinedCorner& q, uint32_t inner) const {
    const uint32_t by_length = levels_above(distance(p, q), longest_, 2);
    return by_length > inner ? by_length : inner;
  }

  bool cut_in_four(const Corners& c, const Levels& l, uint32_t inner) {
    const RefinedCorner m0 = midpoint(c[0], c[1]), m1 = midpoint(c[1], c[2]), m2 = midpoint(c[2], c[0]);
    const uint32_t s01 = level_inside(m0, m1, inner), s12 = level_inside(m1, m2, inner),
                   s20 = level_inside(m2, m0, inner);
    return cut({c[0], m0, m2}, {l[0] - 1, s20, l[2] - 1}, inner) &&
           cut({c[1], m1, m0}, {l[1] - 1, s01, l[0] - 1}, inner) &&
           cut({c[2], m2, m1}, {l[2] - 1, s12, l[1] - 1}, inner) && cut({m0, m1, m2}, {s01, s12, s20}, inner);
  }

  /// Side 0 is halved.
  bool cut_in_two(const Corners& c, const Levels& l) {
    const RefinedCorner m = midpoint(c[0], c[1]);
    const uint32_t s = level_inside(m, c[2], 0);
    return cut({c[0], m, c[2]}, {l[0] - 1, s, 0}, 0) && cut({m, c[1], c[2]}, {l[0] - 1, 0, s}, 0);
  }

  /// Sides 1 and 2 are halved. The rest below their common corner is cut along its shorter diagonal, so that sides
  /// inside are shorter than the longest outside.
  bool cut_in_three(const Corners& c, const Levels& l) {
    const RefinedCorner m1 = midpoint(c[1], c[2]), m2 = midpoint(c[2], c[0]);
    const uint32_t s = level_inside(m1, m2, 0);
    if (!cut({c[2], m2, m1}, {l[2] - 1, s, l[1] - 1}, 0)) return false;
    if (distance(c[0], m1) <= distance(c[1], m2)) {
      const uint32_t d = level_inside(c[0], m1, 0);
      return cut({c[0], c[1], m1}, {0, l[1] - 1, d}, 0) && cut({c[0], m1, m2}, {d, s, l[2] - 1}, 0);
    }
    const uint32_t d = level_inside(c[1], m2, 0);
    return cut({c[0], c[1], m2}, {0, d, l[2] - 1}, 0) && cut({c[1], m1, m2}, {l[1] - 1, s, d}, 0);
  }

  double longest_;
  Emit& emit_;
};

}  // namespace kerf
