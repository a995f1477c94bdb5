#pragma once

#include <cstdint>
#include <limits>

namespace kerf {

/// No primitive, geometry or instance.
inline constexpr uint32_t kNone = 0xFFFFFFFFU;

/// What a ray hit. 24 bytes.
///
/// `primitive` is the caller's own number within `geometry`, however the tree cut or ordered it. u and v: on a triangle
/// the weights of its second and third corner; on a parallelogram the shares of its sides u and v; on a sphere the
/// octahedral map of the outward normal onto [0, 1]^2.
struct Hit {
  float t = std::numeric_limits<float>::infinity();  ///< infinite where nothing was hit, else finite
  float u = 0, v = 0;
  uint32_t primitive = kNone;
  uint32_t geometry = kNone;
  uint32_t instance = kNone;

  explicit operator bool() const { return primitive != kNone; }
  friend bool operator==(const Hit&, const Hit&) = default;
};
static_assert(sizeof(Hit) <= 32);

/// Which of two hits counts: the nearer one, and among equally near ones that with the smaller instance, then geometry,
/// then primitive. A total order, so every structure finds the same hit.
inline bool closer(const Hit& a, const Hit& b) {
  if (a.t != b.t) return a.t < b.t;
  if (a.instance != b.instance) return a.instance < b.instance;
  if (a.geometry != b.geometry) return a.geometry < b.geometry;
  return a.primitive < b.primitive;
}

}  // namespace kerf
