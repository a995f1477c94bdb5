#include "kerf/io/material.h"

namespace kerf {
namespace {

constexpr MaterialTypeEntry kTypes[] = {
    {MaterialType::lambertian, "lambertian", "an ideal diffuse surface (albedo)"},
    {MaterialType::mirror, "mirror", "a perfect reflection (albedo)"},
    {MaterialType::metal, "metal", "a conductor, GGX rough; also rough_mirror (albedo, roughness, metallic)"},
    {MaterialType::glass, "glass", "a smooth dielectric; also dielectric (albedo, refractive_index, transmission)"},
    {MaterialType::light, "light", "emits and reflects nothing (emission, or color and emission_intensity)"},
    {MaterialType::constant, "constant", "shows its albedo whatever the light"},
    {MaterialType::show_normals, "show_normals", "shows the surface's normal as a colour"},
};

}  // namespace

std::span<const MaterialTypeEntry> material_types() { return kTypes; }

}  // namespace kerf
