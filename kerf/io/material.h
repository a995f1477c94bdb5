#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kerf/base/vec3.h"

namespace kerf {

/// An image that colours a surface: 8 bits a channel, red, green and blue side by side, sRGB encoded, row by row from
/// the top.
struct Texture {
  uint32_t width = 0, height = 0;
  std::vector<uint8_t> rgb;  ///< width * height * 3
};

/// How a surface looks.
enum class MaterialType { lambertian, mirror, metal, glass, light, constant, show_normals };

struct MaterialTypeEntry {
  MaterialType type;
  std::string_view name;
  std::string_view sentence;
};

/// All types, in the order of the enumeration. Scene files may also say `rough_mirror` for metal and `dielectric` for
/// glass.
std::span<const MaterialTypeEntry> material_types();

inline constexpr uint32_t kNoTexture = 0xFFFFFFFFU;

/// Colours are linear RGB. A surface of any type with an emission is a light, on both of its sides.
struct Material {
  std::string name;
  MaterialType type = MaterialType::lambertian;
  Vec3f albedo{0.7F, 0.7F,
               0.7F};  ///< in [0, 1]: what is reflected, or let through by glass; of `constant` the radiance
  uint32_t albedo_texture = kNoTexture;  ///< into the textures beside; its colour is multiplied with the albedo
  Vec3f emission;                        ///< radiance, at least 0
  float roughness = 0;            ///< of metal, in [0, 1]: its square is the alpha of the GGX distribution; 0: a mirror
  float metallic = 1;             ///< of metal, in [0, 1]: the share of metal; the rest is lambertian
  float refractive_index = 1.5F;  ///< of glass: inside (against the normal) over outside
  float transmission = 1;         ///< of glass, in [0, 1]: the share of glass; the rest is lambertian
};

}  // namespace kerf
