#pragma once

#include <algorithm>

#include "kerf/base/float4.h"
#include "kerf/geometry/prepared_ray.h"

namespace kerf {

/// A ray for slab tests against the boxes of a WideBvh: at a side b the parameter is b * inverse + offset, one fused
/// operation.
///
/// In position, with e = 2^-24, M the distance from the origin to the scene's farthest side and o the origin's largest
/// coordinate: inverse, the rounding of offset and that of the sum are off by e M, e o and e M; without fused
/// operations that of the product by e (M + o) more; the moved origin by e o, a hit's t by e M. So the origin is moved
/// by 16 e (M + o), towards the outside of boxes, which come out larger by more than any error (the idea: Woop,
/// Benthin, Wald 2013, section 4). A direction component below 2^-30 of the largest is taken to be as large as that: on
/// the way through the scene the ray moves by less than 2^-29 M along it, which the same shift covers.
struct WideRay {
  Float4 inverse, near_offset, far_offset, origin_near, origin_far;
  uint32_t near_upper[3];  ///< of each axis: 1 if boxes are entered at their upper side, else 0
  float slack;             ///< how far outside of a box a ray may be, at most, that is taken to enter it
  /// False where numbers are too large or too small for that: then (b - origin) * inverse is, which takes two
  /// operations and cannot go wrong, whatever the size.
  bool is_fused;

  WideRay(const PreparedRay& ray, const Vec3f& direction, Float4 lower, Float4 upper) {
    const Float4 origin{ray.origin.x, ray.origin.y, ray.origin.z, 0}, d{direction.x, direction.y, direction.z, 0};
    const Float4 to_lower = absolute(lower - origin), to_upper = absolute(upper - origin);
    const Float4 reaches = max(to_lower, to_upper) + absolute(origin);
    const float reach = std::max(std::max(reaches[0], reaches[1]), reaches[2]);
    const float shift = std::max(0x1p-20F * reach, 0x1p-148F);
    const Float4 sizes = absolute(d);
    const float least = 0x1p-30F * std::max(std::max(sizes[0], sizes[1]), sizes[2]);
    is_fused = reach >= 0x1p-60F && reach < 0x1p60F * least;
    slack = 2 * shift;
    const Float4 zero{};
    const float smallest = is_fused ? least : kLeastInverted;
    const Float4 steep = max(sizes, Float4{smallest, smallest, smallest, smallest});
    const auto negative = d < zero;
    const Float4 moved = zero + shift, one = zero + 1;
    inverse = negative ? -one / steep : one / steep;
    origin_near = negative ? origin - moved : origin + moved;
    origin_far = negative ? origin + moved : origin - moved;
    near_offset = -origin_near * inverse;
    far_offset = -origin_far * inverse;
    for (uint32_t axis = 0; axis < 3; ++axis) near_upper[axis] = direction[axis] < 0 ? 1 : 0;
  }

  /// Whether the ray enters a box, the root's, within [t_min, limit].
  bool enters(Float4 lower, Float4 upper, float t_min, float limit) const {
    const auto negative = inverse < Float4{};
    const Float4 nears = ((negative ? upper : lower) - origin_near) * inverse;
    const Float4 fars = ((negative ? lower : upper) - origin_far) * inverse;
    const float near = std::max(std::max(nears[0], nears[1]), std::max(nears[2], t_min));
    const float far = std::min(std::min(fars[0], fars[1]), std::min(fars[2], limit));
    return near <= far;
  }

 private:
  static constexpr float kLeastInverted = 0x1p-126F;  // its inverse is finite

  static Float4 absolute(Float4 a) { return a < 0 ? -a : a; }
};

}  // namespace kerf
