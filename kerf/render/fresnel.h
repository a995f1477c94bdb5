#pragma once

#include <algorithm>
#include <cmath>

#include "kerf/base/vec3.h"

namespace kerf {

/// The share of unpolarised light that a smooth dielectric reflects. `cosine` >= 0 is of the incident direction with
/// the normal on its side; `ratio` the refractive index beyond the surface over that before it. 1 for total reflection.
inline float dielectric_reflectance(float cosine, float ratio) {
  const float sine2 = std::max(0.0F, 1 - cosine * cosine) / (ratio * ratio);
  if (sine2 >= 1) return 1;
  const float cosine_t = std::sqrt(1 - sine2);
  const float parallel = (ratio * cosine - cosine_t) / (ratio * cosine + cosine_t);
  const float perpendicular = (cosine - ratio * cosine_t) / (cosine + ratio * cosine_t);
  return (parallel * parallel + perpendicular * perpendicular) / 2;
}

/// The share of unpolarised light that a conductor with the complex index n + ik reflects (exact; Born and Wolf,
/// "Principles of Optics").
inline float conductor_reflectance(float cosine, float n, float k) {
  const float c2 = cosine * cosine, s2 = std::max(0.0F, 1 - c2);
  const float inner = n * n - k * k - s2;
  const float a2b2 = std::sqrt(inner * inner + 4 * n * n * k * k);
  const float a = std::sqrt(std::max(0.0F, (a2b2 + inner) / 2));
  const float perpendicular = (a2b2 + c2 - 2 * cosine * a) / (a2b2 + c2 + 2 * cosine * a);
  const float t = c2 * a2b2 + s2 * s2, w = 2 * cosine * a * s2;
  return perpendicular * (1 + (t - w) / (t + w)) / 2;
}

/// A conductor's complex index whose reflectance straight on is `reflectance`, that of the artist-friendly metallic
/// Fresnel (Gulbrandsen 2014) without an edge tint of its own.
struct ConductorIndex {
  float n, k;
};
inline ConductorIndex conductor_index(float reflectance) {
  // At 1 k is infinite; this is within a rounding of it.
  const float r = std::clamp(reflectance, 0.0F, 0.99999F), root = std::sqrt(r);
  constexpr float kTint = 0.5F;  // between the two ends that Gulbrandsen's paper mixes
  const float n = kTint * (1 - r) / (1 + r) + (1 - kTint) * (1 + root) / (1 - root);
  const float k2 = (r * (n + 1) * (n + 1) - (n - 1) * (n - 1)) / (1 - r);
  return {n, std::sqrt(std::max(0.0F, k2))};
}

/// Of each colour. Where the reflectance straight on is 0, the index is that of the air around and nothing is
/// reflected.
inline Vec3f conductor_reflectance(float cosine, Vec3f straight_on) {
  Vec3f result;
  for (uint32_t i = 0; i < 3; ++i) {
    const float r = straight_on[i];
    const auto [n, k] = conductor_index(r);
    result[i] = r <= 0 ? 0 : r >= 1 ? 1 : conductor_reflectance(cosine, n, k);
  }
  return result;
}

}  // namespace kerf
