#pragma once

#include <array>

#include "kerf/render/frame.h"
#include "kerf/render/surface.h"

namespace kerf {

/// A direction that light may come from, drawn for the direction that it goes to.
struct BsdfSample {
  Vec3f direction;
  Vec3f weight;       ///< what of its radiance goes on, the cosine included, over the density
  float density = 0;  ///< over solid angle; 0 where the direction is the only one (mirror, glass)
  float scale = 1;    ///< of radiance that went through a dielectric: what compression of its solid angle did to it
};

/// How a point scatters light: a share of one specular lobe (a mirror, a metal, a dielectric), the rest lambertian.
/// Directions point away from the surface.
class Bsdf {
 public:
  /// `to_eye`: where the light goes to, of unit length.
  Bsdf(const Surface& surface, Vec3f to_eye);

  /// Whether it scatters at all; lights and flat colours do not.
  bool scatters() const { return lambertian_ > 0 || specular_ > 0; }
  /// Whether it scatters into more than single directions, so that light may be sampled.
  bool is_smooth() const { return lambertian_ > 0 || (specular_ > 0 && lobe_ == Lobe::ggx); }

  /// The share of radiance from `to_light` that goes to the eye, the cosine included, without single directions.
  Vec3f evaluate(Vec3f to_light) const;
  /// The density with which sample() draws it.
  float density(Vec3f to_light) const;
  /// Draws a direction; false where the light ends.
  bool sample(float lobe, std::array<float, 2> u, BsdfSample& out) const;

 private:
  enum class Lobe { mirror, ggx, glass };

  bool sample_lambertian(std::array<float, 2> u, BsdfSample& out) const;
  bool sample_ggx(std::array<float, 2> u, BsdfSample& out) const;
  bool finish_smooth(Vec3f to_light, BsdfSample& out) const;
  void sample_mirror(BsdfSample& out) const;
  void sample_glass(float choice, BsdfSample& out) const;
  bool is_reflected(Vec3f to_light) const;

  Frame frame_;             // around the shading normal, on the eye's side
  Vec3f geometric_normal_;  // on the eye's side
  Vec3f to_eye_, local_eye_;
  Vec3f albedo_;
  Lobe lobe_ = Lobe::mirror;
  float specular_ = 0, lambertian_ = 0;  // shares
  float alpha_ = 0;
  float ratio_ = 1;  // of glass: the refractive index beyond the surface over that on the eye's side
};

}  // namespace kerf
