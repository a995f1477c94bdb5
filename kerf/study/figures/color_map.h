#pragma once

#include <cstdint>

#include "kerf/base/vec3.h"

namespace kerf {

/// The colours of heat maps, as displayed, for x in [0, 1] (else the nearer end): from near black over purple, red and
/// orange to pale yellow. Perceptually uniform: equal steps of x look equally large, and lightness only rises, so that
/// it can be read in grey too.
Vec3f heat_color(double x);

/// The colour in OKLab (Ottosson: A perceptual color space for image processing, 2020) of one as displayed: lightness
/// from 0 to 1, then green to red, then blue to yellow. Distances in it are how different colours look.
Vec3d oklab_of(Vec3f c);

/// Well apart from each other, neither light nor dark: one for each number, again from the first after the eighth.
Vec3f category_color(uint32_t number);

}  // namespace kerf
