#pragma once

#include <utility>

#include "kerf/trace/ray_box.h"

namespace kerf {

// Box tests from the literature in the place of BoxRay, to be compared with it. Each has the same moved origin, and so
// misses no box that holds a hit: see MovedOrigin. Their own roundings are at most those that it covers.

/// Two divisions for each axis and a branch wherever one can be: as one would write it first. A division is one
/// rounding where BoxRay has two. Without a direction along an axis, the moved origin is compared with the sides.
struct NaiveBoxRay {
  MovedOrigin origin;
  Vec3f direction;

  NaiveBoxRay(const PreparedRay& ray, const Box3f& scene_bounds)
      : origin(ray, scene_bounds), direction(to_float(ray.direction_d)) {}

  bool enters(const float* box, float t_min, float limit, float& entry) const {
    float near = t_min, far = limit;
    for (uint32_t axis = 0; axis < 3; ++axis) {
      const float to_lower = box[Sides::kLower + axis] - origin.for_lower[axis];
      const float to_upper = box[Sides::kUpper + axis] - origin.for_upper[axis];
      if (direction[axis] == 0) {
        if (to_lower > 0 || to_upper < 0) return false;
        continue;
      }
      float first = to_lower / direction[axis], second = to_upper / direction[axis];
      if (first > second) std::swap(first, second);
      if (first > near) near = first;
      if (second < far) far = second;
      if (near > far) return false;
    }
    entry = near;
    return true;
  }
};

/// The sign of the direction chooses the sides, its inverse is multiplied by, and an axis that ends the interval ends
/// the test (Williams, Barrus, Morley, Shirley: An Efficient and Robust Ray-Box Intersection Algorithm, 2005). A NaN
/// comes from a side exactly on the moved origin, which the ray itself does not reach: to miss that box is right.
struct WilliamsBoxRay : BoxRay {
  using BoxRay::BoxRay;

  bool enters(const float* box, float t_min, float limit, float& entry) const {
    float near = (box[near_side[0]] - origin_near[0]) * inverse[0];
    float far = (box[far_side[0]] - origin_far[0]) * inverse[0];
    for (uint32_t axis = 1; axis < 3; ++axis) {
      const float t_near = (box[near_side[axis]] - origin_near[axis]) * inverse[axis];
      const float t_far = (box[far_side[axis]] - origin_far[axis]) * inverse[axis];
      if (near > t_far || t_near > far) return false;
      if (t_near > near) near = t_near;
      if (t_far < far) far = t_far;
    }
    entry = near > t_min ? near : t_min;
    return near <= limit && far >= t_min;
  }
};

/// Whether the line passes between the six edges of the box's outline as the ray sees it, by the sign of Pluecker
/// products, without a division (Mahovsky and Wyvill: Fast Ray-Axis Aligned Bounding Box Overlap Tests with Pluecker
/// Coordinates, 2004); then where it enters. Instead of eight cases by the direction's signs, coordinates are mirrored
/// so that all its components are positive. Rounding a product keeps the order of what is compared, so the only error
/// is that of the differences from the origin, e M, and the origin is moved by 8 e M.
struct PlueckerBoxRay : Sides {
  Vec3f mirror, length, inverse;  ///< of the direction's components: sign, size, 1 / size

  PlueckerBoxRay(const PreparedRay& ray, const Box3f& scene_bounds) : Sides(ray, scene_bounds) {
    for (uint32_t axis = 0; axis < 3; ++axis) {
      const auto component = static_cast<float>(ray.direction_d[axis]);
      mirror[axis] = component < 0 ? -1.0F : 1.0F;
      length[axis] = component < 0 ? -component : component;
      inverse[axis] = 1 / length[axis];
    }
  }

  bool enters(const float* box, float t_min, float limit, float& entry) const {
    float near[3], far[3];
    for (uint32_t axis = 0; axis < 3; ++axis) {
      near[axis] = mirror[axis] * (box[near_side[axis]] - origin_near[axis]);
      far[axis] = mirror[axis] * (box[far_side[axis]] - origin_far[axis]);
      if (far[axis] < t_min * length[axis]) return false;  // the box ends before the ray begins
    }
    for (uint32_t i = 0; i < 3; ++i) {
      const uint32_t k = i == 2 ? 0 : i + 1;
      if (length[i] * far[k] < length[k] * near[i] || length[k] * far[i] < length[i] * near[k]) return false;
    }
    entry = t_min;
    for (uint32_t axis = 0; axis < 3; ++axis) {
      const float t_near = near[axis] * inverse[axis];
      entry = t_near > entry ? t_near : entry;
    }
    return entry <= limit;
  }
};

}  // namespace kerf
