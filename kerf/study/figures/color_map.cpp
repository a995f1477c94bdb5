#include "kerf/study/figures/color_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>

#include "kerf/render/color.h"

namespace kerf {
namespace {

double cubed(double x) { return x * x * x; }

Vec3d linear_of_oklab(Vec3d lab) {
  const double l = cubed(lab.x + 0.3963377774 * lab.y + 0.2158037573 * lab.z);
  const double m = cubed(lab.x - 0.1055613458 * lab.y - 0.0638541728 * lab.z);
  const double s = cubed(lab.x - 0.0894841775 * lab.y - 1.2914855480 * lab.z);
  return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
          -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
          -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

bool is_displayable(Vec3d linear) {
  return std::min({linear.x, linear.y, linear.z}) >= 0 && std::max({linear.x, linear.y, linear.z}) <= 1;
}

Vec3d with_chroma(double lightness, double hue, double chroma) {
  return {lightness, chroma * std::cos(hue), chroma * std::sin(hue)};
}

/// The most chroma that a display can show at a lightness and hue.
double largest_chroma(double lightness, double hue) {
  double least = 0, most = 0.4;
  for (int i = 0; i < 40; ++i) {
    const double middle = (least + most) / 2;
    (is_displayable(linear_of_oklab(with_chroma(lightness, hue, middle))) ? least : most) = middle;
  }
  return least;
}

/// The curve that colours lie on, at no even speed.
Vec3d heat_curve(double x) {
  constexpr double kDark = 0.16, kBright = 0.97, kFirstHue = 285, kLastHue = 468;  // degrees; over 360 to yellow
  const double lightness = kDark + (kBright - kDark) * x;
  const double hue = (kFirstHue + (kLastHue - kFirstHue) * x) * std::numbers::pi / 180;
  return with_chroma(lightness, hue, std::min(0.92 * largest_chroma(lightness, hue), 0.185));
}

constexpr size_t kSamples = 1024;

struct HeatTable {
  std::array<Vec3d, kSamples + 1> colors{};
  std::array<double, kSamples + 1> length{};  ///< of the curve up to each colour, as a share of all of it
};

HeatTable make_heat_table() {
  HeatTable table;
  for (size_t i = 0; i <= kSamples; ++i) {
    table.colors[i] = heat_curve(static_cast<double>(i) / kSamples);
    if (i == 0) continue;
    const Vec3d step = table.colors[i] - table.colors[i - 1];
    table.length[i] = table.length[i - 1] + std::sqrt(dot(step, step));
  }
  const double all = table.length.back();
  for (double& length : table.length) length /= all;
  return table;
}

Vec3f displayed(Vec3d lab) {
  const Vec3d linear = linear_of_oklab(lab);
  return {srgb_encoded(static_cast<float>(linear.x)), srgb_encoded(static_cast<float>(linear.y)),
          srgb_encoded(static_cast<float>(linear.z))};
}

}  // namespace

Vec3f heat_color(double x) {
  static const HeatTable table = make_heat_table();
  x = x > 0 ? std::min(x, 1.0) : 0;  // NaN too
  const auto above =
      static_cast<size_t>(std::lower_bound(table.length.begin() + 1, table.length.end() - 1, x) - table.length.begin());
  const double from = table.length[above - 1], to = table.length[above];
  const double share = to > from ? std::clamp((x - from) / (to - from), 0.0, 1.0) : 0;
  return displayed(table.colors[above - 1] + (table.colors[above] - table.colors[above - 1]) * share);
}

Vec3d oklab_of(Vec3f c) {
  const double r = srgb_decoded(c.x), g = srgb_decoded(c.y), b = srgb_decoded(c.z);
  const double l = std::cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
  const double m = std::cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
  const double s = std::cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  return {0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
          1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
          0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}

Vec3f category_color(uint32_t number) {
  // Hues of one lightness, far apart first.
  constexpr double kHues[] = {255, 40, 145, 320, 85, 200, 0, 290};
  const double hue = kHues[number % std::size(kHues)] * std::numbers::pi / 180;
  constexpr double kLightness = 0.58;
  return displayed(with_chroma(kLightness, hue, std::min(0.95 * largest_chroma(kLightness, hue), 0.18)));
}

}  // namespace kerf
