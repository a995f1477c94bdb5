#pragma once

#include <array>
#include <cstddef>
#include <cstring>
#include <span>
#include <type_traits>

#include "kerf/base/rounding.h"
#include "kerf/base/vec3.h"

namespace kerf {

/// The largest coordinate that is accepted, 2^120 (about 1.3e36): differences and boxes then stay finite in float.
inline constexpr float kMaxCoordinate = 0x1p120F;

/// True for a number that a coordinate may be: finite and at most kMaxCoordinate.
constexpr bool is_coordinate(float x) { return x >= -kMaxCoordinate && x <= kMaxCoordinate; }
constexpr bool is_coordinate(Vec3f p) { return is_coordinate(p.x) && is_coordinate(p.y) && is_coordinate(p.z); }

/// A range of T in one piece, such as a vector or an array.
template <class Range, class T>
concept PackedRange = std::is_convertible_v<Range&, std::span<const T>>;

/// `count` values of type T in the caller's memory, `stride` bytes apart, of any alignment. Copies nothing: the memory
/// must stay where it is, unchanged, as long as a scene uses it.
template <class T>
class Strided {
 public:
  Strided() = default;
  Strided(const void* data, size_t count, size_t stride = sizeof(T))
      : data_(static_cast<const std::byte*>(data)), count_(count), stride_(stride) {}
  Strided(std::span<const T> values) : Strided(values.data(), values.size()) {}
  /// A vector or an array; temporaries are refused, for they would be gone before the scene looks.
  template <PackedRange<T> Range>
  Strided(Range& values) : Strided(std::span<const T>(values)) {}

  size_t size() const { return count_; }
  const void* data() const { return data_; }
  T operator[](size_t i) const {
    T value;
    std::memcpy(&value, data_ + i * stride_, sizeof(T));
    return value;
  }

 private:
  const std::byte* data_ = nullptr;
  size_t count_ = 0;
  size_t stride_ = sizeof(T);
};

using TriangleCorners = std::array<uint32_t, 3>;

/// The three corners of a triangle.
struct Triangle {
  Vec3f a, b, c;
};

/// -0 becomes 0.
constexpr Vec3f cleaned(Vec3f p) { return {without_minus_zero(p.x), without_minus_zero(p.y), without_minus_zero(p.z)}; }

/// Triangles that share vertices, in the caller's memory.
struct TriangleMesh {
  Strided<Vec3f> vertices;
  Strided<TriangleCorners> triangles;  ///< three vertex numbers each

  Triangle triangle(uint32_t i) const {
    const TriangleCorners k = triangles[i];
    return {cleaned(vertices[k[0]]), cleaned(vertices[k[1]]), cleaned(vertices[k[2]])};
  }
};

/// The surface of a ball. A ray crosses it twice: where it enters and where it leaves. Radius 0 is never hit.
struct Sphere {
  Vec3f center;
  float radius = 0;
};

/// The points corner + a * u + b * v for a and b in [0, 1].
struct Parallelogram {
  Vec3f corner, u, v;

  /// The four corners in order around it, exact in double unless magnitudes differ by more than 2^29.
  std::array<Vec3d, 4> corners() const {
    const Vec3d p = to_double(cleaned(corner)), a = to_double(cleaned(u)), b = to_double(cleaned(v));
    return {p, p + a, p + a + b, p + b};
  }
};

}  // namespace kerf
