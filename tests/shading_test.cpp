// The parts that shading is made of: random numbers, directions, microfacets, reflectances, ray origins, colours.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "kerf/geometry/ray_parallelogram.h"
#include "kerf/geometry/ray_sphere.h"
#include "kerf/geometry/ray_triangle.h"
#include "kerf/render/bsdf.h"
#include "kerf/render/color.h"
#include "kerf/render/fresnel.h"
#include "kerf/render/ggx.h"
#include "kerf/render/sampler.h"
#include "kerf/render/surface.h"
#include "tests/support/exact.h"
#include "tests/support/random.h"

namespace kerf {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(Sampler, EveryDimensionOfAPixelIsStratified) {
  // Of 2^k samples one falls into each of 2^k equal parts, and of pairs into each elementary box.
  constexpr uint32_t kCount = 64;
  std::vector<Sampler> samplers;
  for (uint32_t i = 0; i < kCount; ++i) samplers.emplace_back(7, 1234, i);
  for (int dimension = 0; dimension < 20; ++dimension) {
    std::set<int> parts;
    for (Sampler& sampler : samplers) parts.insert(static_cast<int>(sampler.next() * kCount));
    EXPECT_EQ(parts.size(), kCount) << dimension;
    std::vector<std::array<float, 2>> pairs;
    for (Sampler& sampler : samplers) pairs.push_back(sampler.next_pair());
    for (uint32_t wide = 1; wide <= kCount; wide *= 2) {
      std::set<std::pair<int, int>> boxes;
      for (const auto& [x, y] : pairs) {
        boxes.insert({static_cast<int>(x * static_cast<float>(wide)), static_cast<int>(y * (kCount / wide))});
      }
      EXPECT_EQ(boxes.size(), kCount) << dimension << " " << wide;
    }
  }
}

TEST(Sampler, PixelsSeedsAndDimensionsAreNotCorrelated) {
  // The mean product of two uncorrelated uniform numbers is 1/4, give or take 0.22 / sqrt(count).
  constexpr uint32_t kCount = 40000;
  const auto correlation = [&](auto&& pair) {
    double sum = 0;
    for (uint32_t i = 0; i < kCount; ++i) {
      const auto [a, b] = pair(i);
      EXPECT_TRUE(a >= 0 && a < 1 && b >= 0 && b < 1);
      sum += double{a} * b;
    }
    return (sum / kCount - 0.25) / (0.2205 / std::sqrt(kCount));
  };
  EXPECT_LT(
      std::abs(correlation([](uint32_t i) { return std::pair(Sampler(1, i, 0).next(), Sampler(1, i + 1, 0).next()); })),
      4);
  EXPECT_LT(
      std::abs(correlation([](uint32_t i) { return std::pair(Sampler(1, i, 5).next(), Sampler(2, i, 5).next()); })), 4);
  EXPECT_LT(std::abs(correlation([](uint32_t i) {
              Sampler sampler(1, i, 3);
              const float first = sampler.next();
              return std::pair(first, sampler.next());
            })),
            4);
  EXPECT_LT(std::abs(correlation([](uint32_t i) {
              const auto [x, y] = Sampler(1, i, 3).next_pair();
              return std::pair(x, y);
            })),
            4);
}

TEST(Frame, IsOrthonormalAndRightHandedForEveryNormal) {
  test::Random random(3);
  for (int i = 0; i < 10000; ++i) {
    Vec3f z = normalized(Vec3f{random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)});
    if (i < 6) z = Vec3f{i % 3 == 0 ? 1.0F : 0, i % 3 == 1 ? 1.0F : 0, i % 3 == 2 ? 1.0F : 0} * (i < 3 ? 1.0F : -1.0F);
    const Frame frame(z);
    EXPECT_NEAR(dot(frame.x, frame.x), 1, 1e-5);
    EXPECT_NEAR(dot(frame.x, frame.z), 0, 1e-5);
    EXPECT_NEAR(dot(cross(frame.x, frame.y), frame.z), 1, 1e-5);
    const Vec3f v{0.2F, -0.5F, 0.7F}, back = frame.to_local(frame.to_world(v));
    EXPECT_LT(largest(abs(back - v)), 1e-5);
  }
}

TEST(Fresnel, DielectricHasItsTextbookValues) {
  EXPECT_NEAR(dielectric_reflectance(1, 1.5F), 0.04, 1e-6);
  EXPECT_NEAR(dielectric_reflectance(1, 1 / 1.5F), 0.04, 1e-6);
  EXPECT_EQ(dielectric_reflectance(0, 1.5F), 1);
  EXPECT_EQ(dielectric_reflectance(0.5F, 1 / 1.5F), 1) << "total reflection beyond 41.8 degrees";
  EXPECT_LT(dielectric_reflectance(0.8F, 1 / 1.5F), 1);
  // At Brewster's angle only the perpendicular part is reflected.
  const auto cosine = static_cast<float>(std::cos(std::atan(1.5)));
  EXPECT_NEAR(dielectric_reflectance(cosine, 1.5F), 0.5 * std::pow((1 - 2.25) / (1 + 2.25), 2), 1e-6);
  EXPECT_NEAR(dielectric_reflectance(0.3F, 1), 0, 1e-12);
}

TEST(Fresnel, ConductorIsItsColourStraightOnAndWhiteAtTheRim) {
  EXPECT_EQ(conductor_reflectance(0, Vec3f{}), Vec3f{}) << "black reflects nothing";
  for (const float r : {1e-6F, 0.1F, 0.5F, 0.9F, 1.0F}) {
    EXPECT_NEAR(conductor_reflectance(1, Vec3f{r, r, r}).x, r, 2e-5) << r;
    EXPECT_NEAR(conductor_reflectance(0, Vec3f{r, r, r}).y, 1, 1e-5) << r;
  }
  // Gold at 650 nm, n = 0.166, k = 3.15: 0.9381 straight on by ((n-1)^2 + k^2) / ((n+1)^2 + k^2).
  const double straight = (0.834 * 0.834 + 3.15 * 3.15) / (1.166 * 1.166 + 3.15 * 3.15);
  EXPECT_NEAR(conductor_reflectance(1, 0.166F, 3.15F), straight, 1e-6);
}

TEST(Ggx, DensitiesAddUpToOne) {
  for (const float alpha : {0.05F, 0.3F, 1.0F}) {
    for (const float cosine : {0.1F, 0.5F, 1.0F}) {
      const Ggx ggx(alpha);
      const Vec3f w{std::sqrt(1 - cosine * cosine), 0, cosine};
      double area = 0, visible = 0;
      constexpr int kSteps = 600;
      for (int i = 0; i < kSteps; ++i) {
        // theta = x^2 pi/2: more steps near the peak
        const double x = (i + 0.5) / kSteps, theta = x * x * kPi / 2;
        for (int j = 0; j < kSteps; ++j) {
          const double phi = (j + 0.5) / kSteps * 2 * kPi;
          const Vec3f m =
              to_float(Vec3d{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)});
          const double cell = std::sin(theta) * (2 * x * kPi / 2 / kSteps) * (2 * kPi / kSteps);
          area += ggx.density(m) * m.z * cell;
          visible += ggx.visible_density(w, m) * cell;
        }
      }
      EXPECT_NEAR(area, 1, 2e-3) << alpha;
      EXPECT_NEAR(visible, 1, 2e-3) << alpha << " " << cosine;
    }
  }
}

/// Means of functions of drawn normals against their integrals over the density.
TEST(Ggx, VisibleNormalsFollowTheirDensity) {
  for (const float alpha : {0.1F, 0.5F, 1.0F}) {
    for (const float cosine : {0.15F, 0.7F, 1.0F}) {
      const Ggx ggx(alpha);
      const Vec3f w{0.6F * std::sqrt(1 - cosine * cosine), 0.8F * std::sqrt(1 - cosine * cosine), cosine};
      Vec3d drawn, squares, expected;
      constexpr int kDrawn = 1 << 16, kSteps = 700;
      for (uint32_t i = 0; i < kDrawn; ++i) {
        const Vec3d m = to_double(ggx.visible_normal(w, Sampler(1, i, 0).next_pair()));
        drawn = drawn + m;
        for (uint32_t c = 0; c < 3; ++c) squares[c] += m[c] * m[c];
      }
      drawn = drawn / double{kDrawn};
      for (int i = 0; i < kSteps; ++i) {
        const double x = (i + 0.5) / kSteps, theta = x * x * kPi / 2;
        for (int j = 0; j < kSteps; ++j) {
          const double phi = (j + 0.5) / kSteps * 2 * kPi;
          const Vec3d m{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
          const double cell = std::sin(theta) * (2 * x * kPi / 2 / kSteps) * (2 * kPi / kSteps);
          expected = expected + m * (ggx.visible_density(w, to_float(m)) * cell);
        }
      }
      for (uint32_t c = 0; c < 3; ++c) {
        const double error = std::sqrt((squares[c] / kDrawn - drawn[c] * drawn[c]) / kDrawn);
        EXPECT_NEAR(drawn[c], expected[c], 4 * error + 1e-3) << alpha << " " << cosine << " " << c;
      }
    }
  }
}

TEST(Bsdf, IsReciprocalAndItsSamplesCarryItsOwnDensity) {
  Material metal;
  metal.type = MaterialType::metal;
  metal.roughness = 0.6F;
  metal.metallic = 0.5F;
  Surface surface;
  surface.geometric_normal = surface.shading_normal = {0, 0, 1};
  surface.albedo = {0.3F, 0.6F, 0.9F};
  surface.material = &metal;
  for (uint32_t i = 0; i < 1000; ++i) {
    Sampler sampler(5, i, 0);
    const Vec3f a = normalized(cosine_direction(sampler.next_pair()) + Vec3f{0, 0, 0.01F});
    const Bsdf bsdf(surface, a);
    BsdfSample sample;
    const float lobe = sampler.next();
    if (!bsdf.sample(lobe, sampler.next_pair(), sample)) continue;
    const Vec3f b = sample.direction;
    EXPECT_NEAR(sample.density / bsdf.density(b), 1, 1e-5);
    const Vec3f there = bsdf.evaluate(b) / b.z, back = Bsdf(surface, b).evaluate(a) / a.z;
    for (uint32_t c = 0; c < 3; ++c) EXPECT_NEAR(there[c] / back[c], 1, 1e-3);
    EXPECT_EQ(bsdf.evaluate(-b), Vec3f{}) << "nothing comes through";
    EXPECT_EQ(bsdf.density(-b), 0);
  }
}

/// On which side of the plane or sphere a point lies, times a positive number, in long double.
test::Real side_of(const Triangle& t, Vec3f p) {
  using test::to_real;
  return test::volume(to_real(t.b) - to_real(t.a), to_real(t.c) - to_real(t.a), to_real(p) - to_real(t.a));
}

TEST(RayOrigin, LiesStrictlyOnItsSideAtEveryScale) {
  test::Random random(11);
  for (int i = 0; i < 200000; ++i) {
    const auto size = static_cast<float>(std::pow(10.0, random.between(-18.0F, 18.0F)));
    const float away = size * (i % 3 == 0 ? 0 : i % 3 == 1 ? 1.0F : 1000.0F);
    const auto corner = [&] {
      return Vec3f{away + size * random.between(-1, 1), size * random.between(-1, 1), size * random.between(-1, 1)};
    };
    const Triangle triangle{corner(), corner(), corner()};
    if (is_degenerate(triangle)) continue;
    const float root = std::sqrt(random.between(0, 1)), v = random.between(0, 1);
    const SurfacePoint point = triangle_point(triangle, root * (1 - v), root * v);
    Vec3f direction{random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
    if (i % 5 == 0) {  // along the surface
      direction = to_float(cross(point.normal, to_double(direction))) + to_float(point.normal) * 1e-6F;
    }
    const Vec3f origin = offset_origin(point, direction);
    const bool is_above = dot(to_double(direction), point.normal) >= 0;
    ASSERT_TRUE(is_above ? side_of(triangle, origin) > 0 : side_of(triangle, origin) < 0) << i << " size " << size;
    // Near it, too: within some units in the last place of its coordinates.
    const Vec3d moved = to_double(origin) - point.position;
    ASSERT_LT(std::sqrt(dot(moved, moved)), 1e-6 * (double{size} + away) + 1e-40);
    Ray ray;
    ray.origin = origin;
    ray.direction = direction;
    Crossing crossing;
    const float reach = ray.t_max;
    ASSERT_FALSE(intersect(PreparedRay(ray), triangle, reach, crossing)) << i << " size " << size;
  }
}

TEST(RayOrigin, LeavesSpheresToo) {
  test::Random random(13);
  for (int i = 0; i < 100000; ++i) {
    const auto size = static_cast<float>(std::pow(10.0, random.between(-12.0F, 12.0F)));
    const float away = i % 2 == 0 ? 0 : 100 * size;
    const Sphere sphere{{away + size * random.between(-1, 1), away, size * random.between(-1, 1)},
                        size * random.between(0.1F, 1)};
    const Vec3d outward = normalized(Vec3d{random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)});
    const SurfacePoint point = sphere_point(sphere, outward * double{size});
    Vec3f direction{random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
    if (dot(to_double(direction), point.normal) < 0) direction = -direction;
    Ray ray;
    ray.origin = offset_origin(point, direction);
    ray.direction = direction;
    Crossing crossing;
    ASSERT_FALSE(intersect(PreparedRay(ray), sphere, ray.t_max, crossing)) << i << " outward, size " << size;
    ray.origin = offset_origin(point, -direction);
    ray.direction = -direction;
    ASSERT_TRUE(intersect(PreparedRay(ray), sphere, ray.t_max, crossing)) << i << " inward, size " << size;
  }
}

TEST(Color, SrgbAndBack) {
  EXPECT_EQ(srgb_encoded(-1), 0);
  EXPECT_EQ(srgb_encoded(std::nanf("")), 0);
  EXPECT_EQ(srgb_encoded(2), 1);
  EXPECT_NEAR(srgb_encoded(0.5F), 0.735357, 1e-5);
  EXPECT_NEAR(srgb_encoded(0.001F), 0.01292, 1e-6);
  for (int i = 0; i <= 255; ++i) {
    const float x = static_cast<float>(i) / 255;
    EXPECT_NEAR(srgb_encoded(srgb_decoded(x)), x, 1e-5);
  }
}

}  // namespace
}  // namespace kerf
