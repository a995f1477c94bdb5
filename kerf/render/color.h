#pragma once

#include <cmath>

#include "kerf/base/vec3.h"

namespace kerf {

/// Component by component.
constexpr Vec3f scaled(Vec3f a, Vec3f b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

/// How bright a linear colour looks (Rec. 709).
constexpr float luminance(Vec3f c) { return 0.2126F * c.x + 0.7152F * c.y + 0.0722F * c.z; }

inline bool is_finite(Vec3f c) { return std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z); }

/// The sRGB curve (IEC 61966-2-1) for a linear value; what lies outside [0, 1] is clamped.
inline float srgb_encoded(float linear) {
  if (!(linear > 0)) return 0;
  if (linear >= 1) return 1;
  return linear <= 0.0031308F ? 12.92F * linear : 1.055F * std::pow(linear, 1 / 2.4F) - 0.055F;
}

/// Its inverse, for a value in [0, 1].
inline float srgb_decoded(float encoded) {
  return encoded <= 0.04045F ? encoded / 12.92F : std::pow((encoded + 0.055F) / 1.055F, 2.4F);
}

}  // namespace kerf
