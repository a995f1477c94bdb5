#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "kerf/base/vec3.h"
#include "kerf/render/frame.h"

namespace kerf {

/// The GGX distribution of microfacet normals with Smith's masking (Walter et al. 2007; Heitz 2014). Directions are in
/// the frame of the surface, +z its normal.
class Ggx {
 public:
  explicit Ggx(float alpha) : alpha2_(alpha * alpha), alpha_(alpha) {}

  /// The density of normals, by area of the microfacets.
  float density(Vec3f m) const {
    const float d = m.x * m.x + m.y * m.y + alpha2_ * m.z * m.z;  // without cancellation near m.z = 1
    return alpha2_ / (std::numbers::pi_v<float> * d * d);
  }

  /// The share of what faces a direction that is not masked.
  float masking(Vec3f w) const { return 1 / (1 + lambda(w)); }
  /// The share that is seen from both, their heights correlated.
  float masking(Vec3f a, Vec3f b) const { return 1 / (1 + lambda(a) + lambda(b)); }

  /// A normal out of those that are seen from `w` (Heitz 2018, "Sampling the GGX Distribution of Visible Normals"):
  /// on the hemisphere into which the distribution stretches, a point of the disk that `w` sees.
  Vec3f visible_normal(Vec3f w, std::array<float, 2> u) const {
    const Vec3f stretched = normalized(Vec3f{alpha_ * w.x, alpha_ * w.y, w.z});
    auto [x, y] = disk_point(u);
    // `above` points up the rim: of the disk's lower half only a part is seen, into which it is squeezed.
    const Vec3f side = side_of(stretched), above = cross(stretched, side);
    const float share = (1 + stretched.z) / 2;
    y = (1 - share) * std::sqrt(std::max(0.0F, 1 - x * x)) + share * y;
    const float z = std::sqrt(std::max(0.0F, 1 - x * x - y * y));
    const Vec3f n = side * x + above * y + stretched * z;
    return normalized(Vec3f{alpha_ * n.x, alpha_ * n.y, std::max(1e-6F, n.z)});
  }

  /// Its density over solid angle.
  float visible_density(Vec3f w, Vec3f m) const {
    return masking(w) * std::max(0.0F, dot(w, m)) * density(m) / std::max(1e-7F, w.z);
  }

 private:
  float lambda(Vec3f w) const {
    const float tangent2 = (w.x * w.x + w.y * w.y) / (w.z * w.z);
    return (std::sqrt(1 + alpha2_ * tangent2) - 1) / 2;
  }

  /// A direction in the surface, at right angles to w.
  static Vec3f side_of(Vec3f w) {
    const float length2 = w.x * w.x + w.y * w.y;
    return length2 > 1e-14F ? Vec3f{-w.y, w.x, 0} / std::sqrt(length2) : Vec3f{1, 0, 0};
  }

  float alpha2_, alpha_;
};

}  // namespace kerf
