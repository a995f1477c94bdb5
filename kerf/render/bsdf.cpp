#include "kerf/render/bsdf.h"

#include "kerf/render/color.h"
#include "kerf/render/fresnel.h"
#include "kerf/render/ggx.h"

namespace kerf {
namespace {

constexpr float kInvPi = std::numbers::inv_pi_v<float>;

/// Below this a GGX lobe is narrower than float can resolve: a mirror.
constexpr float kLeastAlpha = 1e-3F;

/// The shading normal on the eye's side; the geometric one where the eye is behind the shading normal, which happens
/// near the outline of a smoothed mesh.
Vec3f normal_toward(const Surface& surface, Vec3f to_eye) {
  const float side = dot(surface.geometric_normal, to_eye) < 0 ? -1.0F : 1.0F;
  const Vec3f shading = surface.shading_normal * side;
  return dot(shading, to_eye) > 0 ? shading : surface.geometric_normal * side;
}

Vec3f reflected(Vec3f w, Vec3f n) { return n * (2 * dot(w, n)) - w; }

}  // namespace

Bsdf::Bsdf(const Surface& surface, Vec3f to_eye)
    : frame_(normal_toward(surface, to_eye)), to_eye_(to_eye), albedo_(surface.albedo) {
  const bool is_front = dot(surface.geometric_normal, to_eye) >= 0;
  geometric_normal_ = is_front ? surface.geometric_normal : -surface.geometric_normal;
  local_eye_ = frame_.to_local(to_eye);
  const Material& material = *surface.material;
  switch (material.type) {
    case MaterialType::lambertian:
      break;
    case MaterialType::mirror:
      specular_ = 1;
      break;
    case MaterialType::metal:
      specular_ = material.metallic;
      alpha_ = material.roughness * material.roughness;
      lobe_ = Lobe::ggx;
      break;
    case MaterialType::glass:
      specular_ = material.transmission;
      ratio_ = is_front ? material.refractive_index : 1 / material.refractive_index;
      lobe_ = Lobe::glass;
      break;
    case MaterialType::light:
    case MaterialType::constant:
    case MaterialType::show_normals:
      return;
  }
  lambertian_ = 1 - specular_;
  if (lobe_ == Lobe::ggx && alpha_ < kLeastAlpha) alpha_ = 0;
}

bool Bsdf::is_reflected(Vec3f to_light) const {
  return dot(geometric_normal_, to_light) > 0 && dot(frame_.z, to_light) > 0;
}

Vec3f Bsdf::evaluate(Vec3f to_light) const {
  if (!is_reflected(to_light)) return {};
  const Vec3f l = frame_.to_local(to_light);
  Vec3f result = albedo_ * (lambertian_ * kInvPi * l.z);
  if (specular_ > 0 && lobe_ == Lobe::ggx && alpha_ > 0 && local_eye_.z > 0) {
    const Ggx ggx(alpha_);
    const Vec3f half = normalized(l + local_eye_);
    const Vec3f fresnel = conductor_reflectance(std::max(0.0F, dot(l, half)), albedo_);
    result = result + fresnel * (specular_ * ggx.density(half) * ggx.masking(l, local_eye_) / (4 * local_eye_.z));
  }
  return result;
}

float Bsdf::density(Vec3f to_light) const {
  if (!is_reflected(to_light)) return 0;
  const Vec3f l = frame_.to_local(to_light);
  float result = lambertian_ * kInvPi * l.z;
  if (specular_ > 0 && lobe_ == Lobe::ggx && alpha_ > 0) {
    const Vec3f half = normalized(l + local_eye_);
    const float cosine = dot(half, local_eye_);
    if (cosine > 0) result += specular_ * Ggx(alpha_).visible_density(local_eye_, half) / (4 * cosine);
  }
  return result;
}

bool Bsdf::sample(float lobe, std::array<float, 2> u, BsdfSample& out) const {
  out = {};
  if (lobe >= specular_) return lambertian_ > 0 && sample_lambertian(u, out);
  if (lobe_ == Lobe::ggx && alpha_ > 0) return sample_ggx(u, out);
  // Drawn with the lobe's share as probability, which the weight would have to be divided by and multiplied with.
  if (lobe_ == Lobe::glass) {
    sample_glass(lobe / specular_, out);
  } else {
    sample_mirror(out);
  }
  const bool is_beyond = dot(geometric_normal_, out.direction) < 0;
  return is_beyond == (dot(frame_.z, out.direction) < 0);
}

bool Bsdf::finish_smooth(Vec3f to_light, BsdfSample& out) const {
  out.direction = to_light;
  out.density = density(to_light);
  if (!(out.density > 0)) return false;
  out.weight = evaluate(to_light) / out.density;
  return true;
}

bool Bsdf::sample_lambertian(std::array<float, 2> u, BsdfSample& out) const {
  return finish_smooth(frame_.to_world(cosine_direction(u)), out);
}

bool Bsdf::sample_ggx(std::array<float, 2> u, BsdfSample& out) const {
  const Vec3f half = Ggx(alpha_).visible_normal(local_eye_, u);
  return finish_smooth(frame_.to_world(reflected(local_eye_, half)), out);
}

void Bsdf::sample_mirror(BsdfSample& out) const {
  out.direction = reflected(to_eye_, frame_.z);
  const bool is_metal = lobe_ == Lobe::ggx;
  out.weight = is_metal ? conductor_reflectance(std::max(0.0F, local_eye_.z), albedo_) : albedo_;
}

void Bsdf::sample_glass(float choice, BsdfSample& out) const {
  const float cosine = std::max(0.0F, local_eye_.z);
  const float reflectance = dielectric_reflectance(cosine, ratio_);
  if (choice < reflectance) {
    out.direction = reflected(to_eye_, frame_.z);
    out.weight = {1, 1, 1};
    return;
  }
  const float sine2 = std::max(0.0F, 1 - cosine * cosine) / (ratio_ * ratio_);
  const float cosine_t = std::sqrt(std::max(0.0F, 1 - sine2));
  out.direction = normalized(frame_.z * (cosine / ratio_ - cosine_t) - to_eye_ / ratio_);
  // Radiance is per solid angle, which refraction widens or narrows (Veach 1997, 5.2).
  out.scale = 1 / (ratio_ * ratio_);
  out.weight = albedo_ * out.scale;
}

}  // namespace kerf
