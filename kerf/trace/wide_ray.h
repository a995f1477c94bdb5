#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "kerf/base/box3.h"
#include "kerf/base/float4.h"
#include "kerf/geometry/prepared_ray.h"

namespace kerf {

/// What the kernels of a WideBvh need of a ray, without branches that would be mispredicted: a ray has few nodes to pay
/// for them.
///
/// Boxes of a WideBvh: at a side b the parameter is (b - origin) * inverse, whose error is a share of itself: 4 e, e =
/// 2^-24, with the roundings of the difference, of inverse, of its change and of the product. So inverse is made
/// smaller by 8 e for the near sides and larger for the far ones (the idea: Ize, Robust BVH Ray Traversal, 2013), and
/// where a ray leaves a surface, boxes that end there are not entered again, as they would be if boxes were enlarged. A
/// direction component below 2^-30 of the largest is taken to be as large as that: on the way through the scene the ray
/// moves by less than 2^-29 M along it, M being the distance from the origin to the scene's farthest side; along such
/// an axis the origin is moved by 2^-20 of what M is at most, so that boxes come out larger.
///
/// Boxes in steps, and those of batches: the parameter is b * inverse + offset, one fused operation. In position, with
/// o the origin's largest coordinate: inverse, the roundings of offset and that of the sum are off by e M, 2 e o and e
/// M; a hit's t by e M. With C the scene's largest coordinate M is at most C + o, so the sides are moved by 16 e (C + 2
/// o), towards the outside of boxes, which covers what was said of small components too (the idea: Woop, Benthin, Wald
/// 2013, section 4).
///
/// Triangles: the shear of PreparedRay in float, from one more rounding; see detail::may_hit_triangle().
struct WideRay {
  struct alignas(16) Axes {
    uint32_t kx, ky, kz;  ///< as in PreparedRay
  };
  Float4 inverse, inverse_near, inverse_far;  ///< the latter two: for the near and far sides of boxes
  Float4 origin, origin_near, origin_far;     ///< likewise
  Float4 shear;
  Axes axes;
  uint32_t octant;     ///< a bit for each axis: 1 if boxes are entered at their upper side, else 0
  float t_min, t_max;  ///< without minus zero
  float shift;         ///< of sides, in position
  float t_off;         ///< by which boxes are entered earlier and left later, besides
  /// False where numbers are so large or small that float arithmetic may overflow or lose digits, or t may be negative:
  /// then (b - origin_far_moved()) * inverse is for the far sides and likewise for the near ones, which cannot go
  /// wrong, whatever the size; and triangles are tested in double alone.
  bool is_usual;
  bool valid;  ///< as in PreparedRay

  /// `largest_coordinate`: of the scene's bounds. Most rays are usual and have no small component: what the others need
  /// is elsewhere, so that the division need not wait for it.
  [[gnu::always_inline]] WideRay(const Ray& ray, float largest_coordinate)
      : t_min(ray.t_min + 0.0F), t_max(ray.t_max + 0.0F) {
    const Float4 zero{};
    const Float4 d = first4(ray, offsetof(Ray, direction));  // and t_max, which nobody looks at
    inverse = 1 / d;
    origin = first4(ray, offsetof(Ray, origin)) + zero;  // without minus zero; and t_min
    const Float4 sizes = absolute(d), places = absolute(origin);
    const float longest_xy = std::max(sizes[0], sizes[1]), longest = std::max(longest_xy, sizes[2]);
    const float shortest = std::min(std::min(sizes[0], sizes[1]), sizes[2]);
    const float farthest = std::max(std::max(places[0], places[1]), places[2]);
    const Float4 both = sizes + places;
    const float sum = both[0] + both[1] + both[2];  // no number if one is none
    const float reach = largest_coordinate + 2 * farthest;
    shift = std::max(0x1p-20F * reach, 0x1p-148F);
    const Axes& chosen = kAxes[(sizes[0] < sizes[1] ? 1 : 0) + (longest_xy < sizes[2] ? 2 : 0)];
    axes = chosen;
    is_usual = valid =
        sum <= 0x1p38F && reach <= 0x1p38F && reach >= 0x1p-60F && longest >= 0x1p-40F && t_min >= 0 && t_min <= t_max;
    origin_near = origin_far = origin;
    if (!is_usual || shortest < kFlat * longest) [[unlikely]]
      set_rare(d, longest, farthest);
    inverse_near = inverse * (1 - 0x1p-21F);
    inverse_far = inverse * (1 + 0x1p-21F);
    shear = d * inverse[chosen.kz];
    t_off = 0x1p-24F * reach * (1 / longest);
    octant = signs(inverse);
  }

  /// What is added to b * inverse.
  Float4 near_offset() const { return -(origin * inverse + absolute(inverse) * shift); }
  Float4 far_offset() const { return absolute(inverse) * shift - origin * inverse; }

  /// Moved by the whole shift, so that near sides come out nearer; far sides take the other one.
  Float4 origin_near_moved() const { return origin + with_signs(Float4{} + shift, inverse); }
  Float4 origin_far_moved() const { return origin - with_signs(Float4{} + shift, inverse); }

  /// Whether the ray enters a box, the root's, within [t_min, t_max].
  bool enters(const Box3f& box) const {
    const Float4 nears = origin_near_moved(), fars = origin_far_moved();
    float near = t_min, far = t_max;
    for (uint32_t axis = 0; axis < 3; ++axis) {
      const bool is_upper = (octant >> axis & 1) != 0;
      const float entry = is_upper ? box.upper[axis] : box.lower[axis],
                  exit = is_upper ? box.lower[axis] : box.upper[axis];
      near = std::max(near, (entry - nears[axis]) * inverse[axis]);
      far = std::min(far, (exit - fars[axis]) * inverse[axis]);
    }
    return near <= far;
  }

 private:
  /// By the axis along which the direction is longest: 0; 1; 2, whether or not y is longer than x.
  static constexpr Axes kAxes[4] = {{1, 2, 0}, {2, 0, 1}, {0, 1, 2}, {0, 1, 2}};
  static constexpr float kFlat = 0x1p-30F;            // a component is small below that share of the largest
  static constexpr float kLeastInverted = 0x1p-126F;  // its inverse is finite

  [[gnu::noinline]] void set_rare(Float4 d, float longest, float farthest) {
    const Float4 zero{};
    const Float4 sizes = absolute(d), from_zero = d + zero;  // without minus zero
    const float least = is_usual ? kFlat * longest : kLeastInverted;
    inverse = 1 / with_signs(max(sizes, zero + least), from_zero);
    const Float4 moved = sizes < least ? with_signs(zero + shift, from_zero) : zero;
    origin_near = origin + moved;
    origin_far = origin - moved;
    if (is_usual) return;
    const Float4 no_numbers = (d + origin) * zero;  // not zero where one is not finite
    valid = ((farthest <= kMaxCoordinate) & (longest <= 0x1p100F) & (longest >= 0x1p-100F) & (t_min <= t_max) &
             (no_numbers[0] + no_numbers[1] + no_numbers[2] == 0)) != 0;
  }

  static Float4 first4(const Ray& ray, size_t offset) {
    Float4 values;
    std::memcpy(&values, reinterpret_cast<const char*>(&ray) + offset, sizeof values);
    return values;
  }

  using Bits [[gnu::vector_size(16)]] = int32_t;
  static constexpr int32_t kSizeBits = 0x7FFFFFFF;

  /// Of x, y and z, as bits.
  static uint32_t signs(Float4 a) {
#ifdef __SSE__
    return static_cast<uint32_t>(__builtin_ia32_movmskps(a)) & 7;
#else
    return (a[0] < 0 ? 1U : 0U) | (a[1] < 0 ? 2U : 0U) | (a[2] < 0 ? 4U : 0U);
#endif
  }
  static Float4 absolute(Float4 a) { return reinterpret_cast<Float4>(reinterpret_cast<Bits>(a) & kSizeBits); }
  /// `sizes` are not negative.
  static Float4 with_signs(Float4 sizes, Float4 of) {
    return reinterpret_cast<Float4>(reinterpret_cast<Bits>(sizes) | (reinterpret_cast<Bits>(of) & ~kSizeBits));
  }
};

/// Where rows of a node's sides begin, in numbers: by axis, of those at which a ray enters boxes and of those at which
/// it leaves them. Looked up by WideRay::octant in fewer instructions than they are worked out.
struct SideRows {
  size_t near[3], far[3];
};
template <uint32_t kWidth, uint32_t kRowsOfAxis>
struct SideRowsOf {
  SideRows by_octant[8];

  constexpr SideRowsOf() : by_octant() {
    for (uint32_t octant = 0; octant < 8; ++octant) {
      for (uint32_t axis = 0; axis < 3; ++axis) {
        const uint32_t first = kRowsOfAxis * axis, upper = octant >> axis & 1;
        by_octant[octant].near[axis] = size_t{first + upper} * kWidth;
        by_octant[octant].far[axis] = size_t{first + 1 - upper} * kWidth;
      }
    }
  }
};
template <uint32_t kWidth, uint32_t kRowsOfAxis>
inline constexpr SideRowsOf<kWidth, kRowsOfAxis> kSideRows;

}  // namespace kerf
