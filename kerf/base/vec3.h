#pragma once

#include <cstdint>
#include <type_traits>

namespace kerf {

/// The axes, as indices into a vector.
enum Axis : uint32_t { kX = 0, kY = 1, kZ = 2 };

/// Three numbers: a point, a direction or an extent.
template <class T>
struct Vec3 {
  T x = 0, y = 0, z = 0;

  constexpr T operator[](uint32_t axis) const {
    if (std::is_constant_evaluated()) return axis == 0 ? x : axis == 1 ? y : z;
    return (&x)[axis];  // one load instead of two selects, in the hottest code there is
  }
  constexpr T& operator[](uint32_t axis) {
    if (std::is_constant_evaluated()) return axis == 0 ? x : axis == 1 ? y : z;
    return (&x)[axis];
  }

  friend constexpr Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend constexpr Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
  friend constexpr Vec3 operator*(Vec3 a, T s) { return {a.x * s, a.y * s, a.z * s}; }
  friend constexpr Vec3 operator*(T s, Vec3 a) { return a * s; }
  friend constexpr Vec3 operator/(Vec3 a, T s) { return {a.x / s, a.y / s, a.z / s}; }
  friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
};

using Vec3f = Vec3<float>;
using Vec3d = Vec3<double>;
static_assert(sizeof(Vec3f) == 12 && sizeof(Vec3d) == 24, "components must lie side by side");

template <class T>
constexpr T dot(Vec3<T> a, Vec3<T> b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class T>
constexpr Vec3<T> cross(Vec3<T> a, Vec3<T> b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class T>
constexpr Vec3<T> min(Vec3<T> a, Vec3<T> b) {
  return {a.x < b.x ? a.x : b.x, a.y < b.y ? a.y : b.y, a.z < b.z ? a.z : b.z};
}

template <class T>
constexpr Vec3<T> max(Vec3<T> a, Vec3<T> b) {
  return {a.x > b.x ? a.x : b.x, a.y > b.y ? a.y : b.y, a.z > b.z ? a.z : b.z};
}

/// Componentwise absolute value.
template <class T>
constexpr Vec3<T> abs(Vec3<T> a) {
  return {a.x < 0 ? -a.x : a.x, a.y < 0 ? -a.y : a.y, a.z < 0 ? -a.z : a.z};
}

template <class T>
constexpr T largest(Vec3<T> a) {
  const T xy = a.x > a.y ? a.x : a.y;
  return xy > a.z ? xy : a.z;
}

/// The axis of the largest component; the first of equal ones.
template <class T>
constexpr uint32_t largest_axis(Vec3<T> a) {
  const uint32_t xy = a.x >= a.y ? kX : kY;
  return a[xy] >= a.z ? xy : kZ;
}

constexpr Vec3d to_double(Vec3f a) { return {a.x, a.y, a.z}; }

/// Rounded to the nearest float.
constexpr Vec3f to_float(Vec3d a) {
  return {static_cast<float>(a.x), static_cast<float>(a.y), static_cast<float>(a.z)};
}

}  // namespace kerf
