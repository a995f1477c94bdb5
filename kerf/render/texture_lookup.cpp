#include "kerf/render/texture_lookup.h"

#include <cmath>

#include "kerf/render/color.h"

namespace kerf {
namespace {

/// The linear value of each sRGB byte.
const std::array<float, 256>& linear_values() {
  static const std::array<float, 256> values = [] {
    std::array<float, 256> all{};
    for (size_t i = 0; i < all.size(); ++i) all[i] = srgb_decoded(static_cast<float>(i) / 255);
    return all;
  }();
  return values;
}

Vec3f texel(const Texture& texture, uint32_t x, uint32_t y) {
  const uint8_t* p = &texture.rgb[(size_t{y} * texture.width + x) * 3];
  const auto& linear = linear_values();
  return {linear[p[0]], linear[p[1]], linear[p[2]]};
}

/// The two pixels that a coordinate lies between, and how near it is to the second.
struct Neighbours {
  uint32_t first, second;
  float share;
};

Neighbours neighbours(float at, uint32_t size) {
  const float wrapped = at - std::floor(at);
  float position = (std::isfinite(wrapped) ? wrapped : 0.0F) * static_cast<float>(size) - 0.5F;
  if (position < 0) position += static_cast<float>(size);
  const auto first = static_cast<uint32_t>(position);
  return {first % size, (first + 1) % size, position - static_cast<float>(first)};
}

}  // namespace

Vec3f texture_color(const Texture& texture, std::array<float, 2> uv) {
  if (texture.rgb.empty()) return {1, 1, 1};  // an image without pixels colours nothing
  const Neighbours x = neighbours(uv[0], texture.width), y = neighbours(1 - uv[1], texture.height);
  const auto mix = [](Vec3f a, Vec3f b, float share) { return a * (1 - share) + b * share; };
  return mix(mix(texel(texture, x.first, y.first), texel(texture, x.second, y.first), x.share),
             mix(texel(texture, x.first, y.second), texel(texture, x.second, y.second), x.share), y.share);
}

}  // namespace kerf
