#include "kerf/study/ray_order.h"

#include <algorithm>
#include <cmath>

#include "kerf/base/box3.h"
#include "kerf/base/radix_sort.h"

namespace kerf {
namespace {

constexpr uint32_t kOriginBits = 10, kDirectionBits = 9;  // of each axis: with three signs 60 of 64 bits

/// Which of 2^bits equal parts of [lower, upper] a number lies in.
uint64_t part_of(double x, double lower, double upper, uint32_t bits) {
  const auto last = static_cast<double>((1U << bits) - 1);
  const double part = upper > lower ? (x - lower) / (upper - lower) * (last + 1) : 0;
  return part > 0 ? static_cast<uint64_t>(std::min(part, last)) : 0;  // not a number: 0
}

/// The bits of three numbers in turn, the highest first.
uint64_t interleaved(const uint64_t (&parts)[3], uint32_t bits) {
  uint64_t code = 0;
  for (uint32_t bit = bits; bit-- > 0;) {
    for (const uint64_t part : parts) code = code << 1 | (part >> bit & 1);
  }
  return code;
}

uint64_t key_of(const Ray& ray, const Box3f& box) {
  uint64_t signs = 0, origin[3], direction[3];
  const float largest =
      std::max({std::abs(ray.direction.x), std::abs(ray.direction.y), std::abs(ray.direction.z), 1e-30F});
  for (uint32_t axis = 0; axis < 3; ++axis) {
    signs = signs << 1 | (ray.direction[axis] < 0 ? 1 : 0);
    origin[axis] = part_of(ray.origin[axis], box.lower[axis], box.upper[axis], kOriginBits);
    direction[axis] = part_of(std::abs(ray.direction[axis]) / largest, 0, 1, kDirectionBits);
  }
  return (signs << 3 * kOriginBits | interleaved(origin, kOriginBits)) << 3 * kDirectionBits |
         interleaved(direction, kDirectionBits);
}

}  // namespace

std::vector<uint32_t> ray_order(std::span<const Ray> rays) {
  Box3f box;
  for (const Ray& ray : rays) box.extend(ray.origin);
  std::vector<KeyedNumber> items(rays.size());
  for (size_t i = 0; i < rays.size(); ++i) items[i] = {key_of(rays[i], box), static_cast<uint32_t>(i)};
  radix_sort(items);
  std::vector<uint32_t> order;
  order.reserve(items.size());
  for (const KeyedNumber& item : items) order.push_back(item.number);
  return order;
}

}  // namespace kerf
