#pragma once

#include <algorithm>

#include "kerf/base/float4.h"
#include "kerf/geometry/prepared_ray.h"

namespace kerf {

/// What the kernels of a WideBvh need of a ray, without branches that would be mispredicted: a ray has few nodes to pay
/// for them.
///
/// Boxes: at a side b the parameter is b * inverse + offset, one fused operation. In position, with e = 2^-24, M the
/// distance from the origin to the scene's farthest side and o the origin's largest coordinate: inverse, the rounding
/// of offset and that of the sum are off by e M, e o and e M; without fused operations that of the product by e (M + o)
/// more; the moved origin by e o, a hit's t by e M. So the origin is moved by 16 e (M + o), towards the outside of
/// boxes, which come out larger by more than any error (the idea: Woop, Benthin, Wald 2013, section 4). A direction
/// component below 2^-30 of the largest is taken to be as large as that: on the way through the scene the ray moves by
/// less than 2^-29 M along it, which the same shift covers.
///
/// Triangles: the shear of PreparedRay in float, from one more rounding; see detail::may_hit_triangle().
struct WideRay {
  Float4 inverse, near_offset, far_offset, origin_near, origin_far;
  Float4 origin, shear;
  uint32_t near_upper[3];  ///< of each axis: 1 if boxes are entered at their upper side, else 0
  uint32_t kx, ky, kz;     ///< as in PreparedRay
  float t_min, t_max;
  float direction_z;  ///< along kz
  /// False where numbers are too large or too small for that: then (b - origin) * inverse is, which takes two
  /// operations and cannot go wrong, whatever the size.
  bool is_fused;
  bool valid;  ///< as in PreparedRay

  WideRay(const Ray& ray, Float4 lower, Float4 upper) : t_min(ray.t_min), t_max(ray.t_max) {
    const Float4 zero{};
    const Float4 d = Float4{ray.direction.x, ray.direction.y, ray.direction.z, 0} + zero;
    origin = Float4{ray.origin.x, ray.origin.y, ray.origin.z, 0} + zero;  // without minus zero
    const Float4 sizes = absolute(d), places = absolute(origin);
    const float longest_xy = std::max(sizes[0], sizes[1]), longest = std::max(longest_xy, sizes[2]);
    const Float4 no_numbers = (d + origin) * zero;  // not zero where one is not finite
    valid = ((largest(places) <= kMaxCoordinate) & (longest <= 0x1p100F) & (longest >= 0x1p-100F) & (t_min <= t_max) &
             (no_numbers[0] + no_numbers[1] + no_numbers[2] == 0)) != 0;
    const auto y_is_larger = static_cast<uint32_t>(sizes[0] < sizes[1]);
    const auto z_is_largest = static_cast<uint32_t>(longest_xy < sizes[2]);
    kz = (y_is_larger & ~z_is_largest) | z_is_largest << 1;
    kx = (0b001001U >> (2 * kz)) & 3;
    ky = (0b010010U >> (2 * kz)) & 3;
    const float reach = largest(max(absolute(lower - origin), absolute(upper - origin)) + places);
    const float shift = std::max(0x1p-20F * reach, 0x1p-148F), least = 0x1p-30F * longest;
    is_fused = reach >= 0x1p-60F && reach < 0x1p60F * least && longest <= 0x1p50F;
    const auto negative = d < zero;
    // Not a choice of two: the division would have to wait for it.
    const auto invert = [&](float smallest) {
      const Float4 steep = max(sizes, zero + smallest);
      inverse = 1 / (negative ? -steep : steep);
    };
    invert(least);
    if (!is_fused) [[unlikely]]
      invert(kLeastInverted);
    const Float4 moved = negative ? zero - shift : zero + shift;
    origin_near = origin + moved;
    origin_far = origin - moved;
    near_offset = -origin_near * inverse;
    far_offset = -origin_far * inverse;
    direction_z = d[kz];
    shear = d * inverse[kz];
    near_upper[0] = ray.direction.x < 0 ? 1 : 0;
    near_upper[1] = ray.direction.y < 0 ? 1 : 0;
    near_upper[2] = ray.direction.z < 0 ? 1 : 0;
  }

  /// Whether the ray enters a box, the root's, within [t_min, t_max].
  bool enters(Float4 lower, Float4 upper) const {
    const auto negative = inverse < Float4{};
    const Float4 nears = ((negative ? upper : lower) - origin_near) * inverse;
    const Float4 fars = ((negative ? lower : upper) - origin_far) * inverse;
    const float near = std::max(std::max(nears[0], nears[1]), std::max(nears[2], t_min));
    const float far = std::min(std::min(fars[0], fars[1]), std::min(fars[2], t_max));
    return near <= far;
  }

 private:
  static constexpr float kLeastInverted = 0x1p-126F;  // its inverse is finite

  static Float4 absolute(Float4 a) {
    using Bits [[gnu::vector_size(16)]] = int32_t;
    return reinterpret_cast<Float4>(reinterpret_cast<Bits>(a) & 0x7FFFFFFF);
  }
  static float largest(Float4 a) { return std::max(std::max(a[0], a[1]), a[2]); }
};

}  // namespace kerf
