// The scalar primitive tests against evaluation in long double, and each sentence of their contracts.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

#include "kerf/geometry/geometry.h"
#include "kerf/geometry/ray_parallelogram.h"
#include "kerf/geometry/ray_sphere.h"
#include "kerf/geometry/ray_triangle.h"
#include "tests/support/exact.h"
#include "tests/support/property.h"

namespace kerf::test {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr Triangle kUnitTriangle = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};

template <class Shape>
std::optional<Crossing> cross(const Shape& shape, const Ray& ray) {
  const PreparedRay prepared(ray);
  Crossing crossing;
  if (!prepared.valid || !intersect(prepared, shape, prepared.t_max, crossing)) return std::nullopt;
  return crossing;
}

/// A ray and the flat shape that it is aimed at, near or on or past the border.
struct Aimed {
  Vec3f corner, u, v;
  Ray ray;
};

/// A triangle or parallelogram by its corner and sides: of any form, a sliver of aspect 1e-6, seen at a grazing angle,
/// of any size from 2^-100 to 2^80, far away or near the origin of the coordinates.
Aimed draw_aimed() {
  Aimed aimed;
  aimed.u = draw_vector();
  aimed.v = draw_vector();
  const int form = draw_int(0, 3);
  if (form == 1) aimed.v = aimed.u * draw_unit() + 1e-6F * aimed.v;  // sliver
  aimed.corner = draw_int(0, 1) == 0 ? draw_vector() : 50.0F * draw_vector();
  Vec3f direction = draw_vector();
  if (form == 2) direction = draw_unit() * aimed.u + draw_unit() * aimed.v + 1e-4F * direction;  // grazing
  if (form == 3) direction[static_cast<uint32_t>(draw_int(0, 2))] = 0;
  const float share_u = 1.2F * draw_share() - 0.1F, share_v = 1.2F * draw_share() - 0.1F;
  const Vec3f target = aimed.corner + share_u * aimed.u + share_v * aimed.v;
  aimed.ray.origin = target - (1 + 10 * draw_share()) * direction;
  aimed.ray.direction = direction * std::ldexp(1.0F, draw_int(-20, 20));
  const float scale = std::ldexp(1.0F, draw_int(-100, 80));
  for (Vec3f* p : {&aimed.corner, &aimed.u, &aimed.v, &aimed.ray.origin}) *p = *p * scale;
  return aimed;
}

/// How many drawn cases were judged as hits and as misses: a test that never hits proves nothing.
struct Judged {
  int hits = 0, misses = 0;
};

/// A crossing must be there where the ray passes inside by more than doubles are off, absent where it passes outside by
/// as much, and right. Half of 1e-6 would be float's own rounding many times over; it is the promise.
void judge(const ExactCrossing& exact, const Ray& ray, const std::optional<Crossing>& got, Judged& judged) {
  const Real blur = 0x1p-48L * exact.reach;
  const bool in_range = exact.t >= ray.t_min * 1.000001L && exact.t <= ray.t_max;
  if (exact.is_parallel || exact.width < blur) return;
  if (exact.margin < -blur) {
    RC_ASSERT(!got);
    ++judged.misses;
  } else if (exact.margin > blur && in_range && exact.t < 1e37L) {
    RC_ASSERT(got.has_value());
    ++judged.hits;
  }
  if (!got) return;
  const Real share_blur = 1e-7L + 4 * blur / exact.width;  // what the exact method and a clamp at the border leave
  RC_ASSERT(std::abs(got->t - exact.t) <= 1e-6L * std::abs(exact.t));
  RC_ASSERT(std::abs(got->u - exact.u) <= 1e-6L * std::abs(exact.u) + share_blur);
  RC_ASSERT(std::abs(got->v - exact.v) <= 1e-6L * std::abs(exact.v) + share_blur);
}

TEST(RayTriangle, AgreesWithSignedVolumesInLongDouble) {
  Judged judged;
  check_property(6000, [&] {
    const Aimed aimed = draw_aimed();
    const Triangle triangle{aimed.corner, aimed.corner + aimed.u, aimed.corner + aimed.v};
    RC_PRE(!is_degenerate(triangle));
    judge(cross_exactly(triangle, aimed.ray), aimed.ray, cross(triangle, aimed.ray), judged);
  });
  EXPECT_GT(judged.hits, 1000);
  EXPECT_GT(judged.misses, 1000);
}

TEST(RayParallelogram, AgreesWithSignedVolumesInLongDouble) {
  Judged judged;
  check_property(6000, [&] {
    const Aimed aimed = draw_aimed();
    const Parallelogram shape{aimed.corner, aimed.u, aimed.v};
    RC_PRE(!is_degenerate(shape));
    judge(cross_exactly(shape, aimed.ray), aimed.ray, cross(shape, aimed.ray), judged);
  });
  EXPECT_GT(judged.hits, 1000);
  EXPECT_GT(judged.misses, 500);
}

TEST(RayTriangle, WeightsBelongToTheSecondAndThirdCorner) {
  const auto crossing = cross(kUnitTriangle, {.origin = {0.25F, 0.5F, 0}, .direction = {0, 0, 2}});
  ASSERT_TRUE(crossing);
  EXPECT_EQ(crossing->t, 0.5F);  // in lengths of the direction
  EXPECT_EQ(crossing->u, 0.25F);
  EXPECT_EQ(crossing->v, 0.5F);
  EXPECT_TRUE(cross(kUnitTriangle, {.origin = {0.25F, 0.5F, 2}, .direction = {0, 0, -1}})) << "the other side counts";
}

TEST(RayTriangle, EdgesAndCornersBelongToIt) {
  for (const auto& [x, y] :
       {std::pair(0.0F, 0.0F), {1, 0}, {0, 1}, {0.5F, 0}, {0, 0.5F}, {0.5F, 0.5F}, {-0.0F, 0.25F}}) {
    for (const float slope : {0.0F, 0.25F, -0.5F}) {
      const auto crossing =
          cross(kUnitTriangle, {.origin = {x - slope, y + slope, 0}, .direction = {slope, -slope, 1}});
      ASSERT_TRUE(crossing) << x << ' ' << y;
      EXPECT_EQ(crossing->u, x);
      EXPECT_EQ(crossing->v, y);
    }
  }
  const float just_outside = -1e-30F;
  EXPECT_FALSE(cross(kUnitTriangle, {.origin = {just_outside, 0.5F, 0}, .direction = {0, 0, 1}}));
  EXPECT_FALSE(cross(kUnitTriangle, {.origin = {0.5F, std::nextafter(0.5F, 1.0F), 0}, .direction = {0, 0, 1}}));
}

TEST(RayInterval, IsClosedAtBothEnds) {
  const auto hits = [](float t_min, float t_max) {
    const Ray ray{.origin = {0.25F, 0.25F, 0}, .t_min = t_min, .direction = {0, 0, 1}, .t_max = t_max};
    const bool triangle = cross(kUnitTriangle, ray).has_value();
    const bool parallelogram = cross(Parallelogram{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}, ray).has_value();
    const bool sphere = cross(Sphere{{0.25F, 0.25F, 3}, 2}, ray).has_value();  // enters at 1, leaves at 5
    EXPECT_EQ(triangle, parallelogram);
    if (t_max < 5) {
      EXPECT_EQ(triangle, sphere);
    }
    return triangle;
  };
  const float below = std::nextafter(1.0F, 0.0F), above = std::nextafter(1.0F, 2.0F);
  EXPECT_TRUE(hits(1, 1));
  EXPECT_TRUE(hits(0, 1));
  EXPECT_TRUE(hits(1, 2));
  EXPECT_TRUE(hits(-kInfinity, kInfinity));
  EXPECT_TRUE(hits(-5, 1));
  EXPECT_FALSE(hits(0, below));
  EXPECT_FALSE(hits(above, 2));
  EXPECT_FALSE(hits(above, kInfinity));
  EXPECT_FALSE(hits(2, 0));
  EXPECT_FALSE(hits(kInfinity, kInfinity));
  EXPECT_FALSE(hits(kNaN, 2));
  EXPECT_FALSE(hits(0, kNaN));
}

TEST(RayInterval, NegativeTLiesBehindTheOrigin) {
  Ray ray{.origin = {0.25F, 0.25F, 4}, .t_min = -3, .direction = {0, 0, 1}};
  ASSERT_TRUE(cross(kUnitTriangle, ray));
  EXPECT_EQ(cross(kUnitTriangle, ray)->t, -3);
  ray.t_min = std::nextafter(-3.0F, 0.0F);
  EXPECT_FALSE(cross(kUnitTriangle, ray));
}

TEST(RayInterval, TheOriginOnThePrimitiveIsAtZero) {
  const auto crossing = cross(kUnitTriangle, {.origin = {0.25F, 0.25F, 1}, .direction = {0, 0, -1}, .t_max = 0});
  ASSERT_TRUE(crossing);
  EXPECT_EQ(crossing->t, 0);
  EXPECT_FALSE(std::signbit(crossing->t));
}

TEST(RayInterval, TBeyondFloatIsNoHit) {
  const Triangle far{{-1e36F, -1e36F, 1e36F}, {1e36F, -1e36F, 1e36F}, {0, 1e36F, 1e36F}};
  EXPECT_FALSE(cross(far, {.origin = {0, 0, 0}, .direction = {0, 0, 1e-3F}}));
  EXPECT_TRUE(cross(far, {.origin = {0, 0, 0}, .direction = {0, 0, 1}}));
}

TEST(RayValidity, RaysThatHitNothing) {
  const Ray good{.origin = {0.25F, 0.25F, 0}, .direction = {0, 0, 1}};
  EXPECT_TRUE(PreparedRay(good).valid);
  for (uint32_t axis = 0; axis < 3; ++axis) {
    for (const float bad : {kNaN, kInfinity, -kInfinity, std::nextafter(0x1p120F, kInfinity)}) {
      Ray ray = good;
      ray.origin[axis] = bad;
      EXPECT_FALSE(PreparedRay(ray).valid) << axis << ' ' << bad;
    }
    for (const float bad : {kNaN, kInfinity, -kInfinity, std::nextafter(0x1p100F, kInfinity)}) {
      Ray ray = good;
      ray.direction[axis] = bad;
      EXPECT_FALSE(PreparedRay(ray).valid) << axis << ' ' << bad;
    }
  }
  for (const float length : {0.0F, -0.0F, std::nextafter(0x1p-100F, 0.0F), 1e-40F}) {
    Ray ray = good;
    ray.direction = {0, 0, length};
    EXPECT_FALSE(PreparedRay(ray).valid) << length;
  }
  for (const float length : {0x1p-100F, -0x1p-100F, 0x1p100F, -0x1p100F}) {
    Ray ray = good;
    ray.direction = {1e-42F, 0, length};
    ray.t_min = -kInfinity;
    EXPECT_TRUE(PreparedRay(ray).valid) << length;
    EXPECT_TRUE(cross(kUnitTriangle, ray)) << length;
  }
  Ray edge = good;
  edge.origin.z = -0x1p120F;
  EXPECT_TRUE(PreparedRay(edge).valid);
}

TEST(Degenerate, TrianglesWithoutAreaAreNeverHit) {
  const Vec3f p{0.1F, 0.2F, 0.3F}, q{1.7F, -0.4F, 2.9F};
  // Corners on one line in steps that float represents exactly.
  for (const Triangle& triangle : {Triangle{p, p, p},
                                   {p, q, q},
                                   {q, p, q},
                                   {p, p, q},
                                   {{0, 0, 1}, {1, 0.5F, 1}, {2, 1, 1}},
                                   {{3, 3, 3}, {1, 1, 1}, {-5, -5, -5}}}) {
    EXPECT_TRUE(is_degenerate(triangle));
    for (const Vec3f target : {triangle.a, triangle.b, triangle.c}) {
      for (const Vec3f direction : {Vec3f{0, 0, 1}, {1, 0, 0}, {0.3F, -0.5F, 0.7F}}) {
        EXPECT_FALSE(cross(triangle, {.origin = target - direction, .direction = direction}));
      }
    }
  }
  EXPECT_TRUE(is_degenerate(Parallelogram{p, {1, 2, 3}, {-2, -4, -6}}));
  EXPECT_FALSE(cross(Parallelogram{{0, 0, 1}, {1, 0, 0}, {2, 0, 0}}, {.origin = {}, .direction = {0, 0, 1}}));
  const Triangle thin{{0, 0, 1}, {1, 0, 1}, {0.5F, 1e-45F, 1}};
  EXPECT_FALSE(is_degenerate(thin));
  EXPECT_TRUE(cross(thin, {.origin = {0.5F, 0, 0}, .direction = {0, 0, 1}}));
}

TEST(MinusZero, ChangesNothing) {
  const Sphere spheres[2] = {{{0, 0, 5}, 2}, {{-0.0F, -0.0F, 5}, 2}};
  const Parallelogram shapes[2] = {{{0, 0, 5}, {1, 0, 0}, {0, 1, 0}},
                                   {{-0.0F, -0.0F, 5}, {1, -0.0F, 0}, {-0.0F, 1, -0.0F}}};
  const Vec3f corners[6] = {{0, 0, 5}, {1, 0, 5}, {0, 1, 5}, {-0.0F, -0.0F, 5}, {1, -0.0F, 5}, {-0.0F, 1, 5}};
  const TriangleCorners triangles[2] = {{0, 1, 2}, {3, 4, 5}};
  const Geometry geometries[] = {
      {Strided<Sphere>(spheres, 2)}, {Strided<Parallelogram>(shapes, 2)}, {TriangleMesh{{corners, 6}, {triangles, 2}}}};
  for (const Geometry& geometry : geometries) {
    std::optional<Crossing> first;
    for (const float zero : {0.0F, -0.0F}) {
      const PreparedRay ray(Ray{.origin = {zero, zero, zero}, .direction = {zero, zero, 1}});
      for (uint32_t primitive = 0; primitive < 2; ++primitive) {
        Crossing crossing;
        ASSERT_TRUE(intersect(geometry, primitive, ray, kInfinity, crossing)) << kind_name(geometry);
        if (!first) first = crossing;
        EXPECT_EQ(std::memcmp(&crossing, &*first, sizeof crossing), 0) << kind_name(geometry) << ", the very bits";
        const Box3f box = primitive_bounds(geometry, primitive);
        for (uint32_t axis = 0; axis < 3; ++axis) {
          EXPECT_FALSE(box.lower[axis] == 0 && std::signbit(box.lower[axis])) << kind_name(geometry);
          EXPECT_FALSE(box.upper[axis] == 0 && std::signbit(box.upper[axis])) << kind_name(geometry);
        }
      }
    }
  }
}

TEST(RayParallelogram, BorderIsInsideAndSharedEdgesHaveNoGap) {
  const Parallelogram shape{{0, 0, 1}, {2, 1, 0}, {-1, 1, 0}};
  for (const auto& [u, v] :
       {std::pair(0.0F, 0.0F), {1, 0}, {0, 1}, {1, 1}, {0.5F, 0}, {0, 0.5F}, {1, 0.25F}, {0.75F, 1}}) {
    const auto crossing = cross(shape, {.origin = {2 * u - v, u + v, 0}, .direction = {0, 0, 1}});
    ASSERT_TRUE(crossing) << u << ' ' << v;
    EXPECT_EQ(crossing->u, u);
    EXPECT_EQ(crossing->v, v);
  }
  // A triangle on its far side: rays aimed at the common edge hit one of the two, mostly not both.
  int both = 0;
  check_property(3000, [&] {
    const Vec3f p{std::round(100 * draw_unit()), std::round(100 * draw_unit()), std::round(100 * draw_unit())};
    const Vec3f u{std::round(100 * draw_unit()), std::round(100 * draw_unit()), std::round(100 * draw_unit())};
    const Vec3f v{std::round(100 * draw_unit()), std::round(100 * draw_unit()), std::round(100 * draw_unit())};
    const Parallelogram left{p, u, v};
    const Triangle right{p + u, p + u + v, p + u * 2.0F + v};
    RC_PRE(!is_degenerate(left) && !is_degenerate(right));
    const float share = 0.1F + 0.8F * draw_share();
    const Vec3f target = p + u + share * v, origin = target + 100.0F * draw_vector();
    const Ray ray{.origin = origin, .direction = target - origin};
    RC_PRE(PreparedRay(ray).valid && !cross_exactly(left, ray).is_parallel);
    const bool hits_left = cross(left, ray).has_value(), hits_right = cross(right, ray).has_value();
    RC_ASSERT(hits_left || hits_right);
    both += hits_left && hits_right ? 1 : 0;
  });
  EXPECT_LT(both, 1500);
}

TEST(RaySphere, AgreesWithTheQuadraticInLongDouble) {
  Judged judged;
  check_property(6000, [&] {
    const float scale = std::ldexp(1.0F, draw_int(-60, 60)), radius = scale * (0.01F + draw_share());
    const Sphere sphere{draw_vector() * scale, radius};
    const Vec3f target = sphere.center + draw_vector() * radius;
    const Vec3f direction = draw_vector();
    RC_PRE(largest(abs(direction)) > 0.01F);
    const Ray ray{.origin = target - direction * (scale * 8 * draw_unit()), .direction = direction};
    const ExactSphere exact = cross_exactly(sphere, ray);
    const auto got = cross(sphere, ray);
    const Real blur = 0x1p-40L * (exact.margin + scale * 16), nearest = exact.enter >= 0 ? exact.enter : exact.leave;
    RC_PRE(std::abs(exact.margin) > 1e-7L * scale);
    RC_PRE(std::abs(exact.enter) > 1e-5L * scale && std::abs(exact.leave) > 1e-5L * scale);
    if (exact.margin < -blur || nearest < 0) {
      RC_ASSERT(!got);
      ++judged.misses;
      return;
    }
    RC_ASSERT(got.has_value());
    ++judged.hits;
    RC_ASSERT(std::abs(got->t - nearest) <= 1e-6L * nearest);
    const Vec3r normal = (to_real(ray.origin) + nearest * to_real(direction) - to_real(sphere.center)) / Real{radius};
    const Geometry geometry{Strided<Sphere>(&sphere, 1)};
    const Vec3f found = unit_normal(geometry, 0, got->u, got->v);
    RC_ASSERT(largest(abs(to_real(found) - normal)) < 1e-6L);
  });
  EXPECT_GT(judged.hits, 1000);
  EXPECT_GT(judged.misses, 500);
}

TEST(RaySphere, EntryThenExitThenNothing) {
  const Sphere sphere{{0, 0, 5}, 2};
  Ray ray{.origin = {}, .direction = {0, 0, 1}};
  EXPECT_EQ(cross(sphere, ray)->t, 3);
  ray.t_min = std::nextafter(3.0F, 4.0F);
  EXPECT_EQ(cross(sphere, ray)->t, 7) << "from inside: the exit";
  ray.t_min = 7;
  EXPECT_EQ(cross(sphere, ray)->t, 7);
  ray.t_min = std::nextafter(7.0F, 8.0F);
  EXPECT_FALSE(cross(sphere, ray));
  ray = {.origin = {0, 0, 5}, .direction = {0, 0, 1}, .t_max = 1};
  EXPECT_FALSE(cross(sphere, ray)) << "the ball inside is not hit";
  ray = {.origin = {2, 0, 0}, .direction = {0, 0, 1}};
  ASSERT_TRUE(cross(sphere, ray)) << "a tangent touches";
  EXPECT_EQ(cross(sphere, ray)->t, 5);
  ray.origin.x = std::nextafter(2.0F, 3.0F);
  EXPECT_FALSE(cross(sphere, ray));
  EXPECT_FALSE(cross(Sphere{{0, 0, 5}, 0}, {.origin = {}, .direction = {0, 0, 1}}));
}

TEST(RaySphere, IsExactFarAwayAndFiniteWhereItIsNextToNothing) {
  const Sphere ball{{0, 0, 0}, 1};
  const auto far = cross(ball, {.origin = {0, 0.5F, -1e6F}, .direction = {0, 0, 1}});
  ASSERT_TRUE(far);
  const Vec3f normal = unit_normal(Geometry{Strided<Sphere>(&ball, 1)}, 0, far->u, far->v);
  EXPECT_LT(largest(abs(to_real(normal) - Vec3r{0, 0.5L, -std::sqrt(0.75L)})), 1e-6L);
  // So small that its two crossings round to one distance even in double.
  const Sphere dot_sphere{{0, 0, 1}, 1e-20F};
  const auto crossing = cross(dot_sphere, {.origin = {}, .direction = {0, 0, 1}});
  ASSERT_TRUE(crossing);
  EXPECT_EQ(crossing->t, 1);
  EXPECT_FALSE(std::isnan(crossing->u));
  EXPECT_FALSE(std::isnan(crossing->v));
  EXPECT_EQ(unit_normal(Geometry{Strided<Sphere>(&dot_sphere, 1)}, 0, crossing->u, crossing->v), (Vec3f{0, 0, -1}));
}

TEST(Octahedral, GoesThereAndBack) {
  const Sphere sphere{{0, 0, 0}, 1};
  const Geometry geometry{Strided<Sphere>(&sphere, 1)};
  check_property(3000, [&] {
    Vec3f direction = draw_vector();
    if (draw_int(0, 3) == 0) direction[static_cast<uint32_t>(draw_int(0, 2))] = draw_int(0, 1) == 0 ? 0.0F : -0.0F;
    const Real size = length(to_real(direction));
    RC_PRE(size > 1e-3L);
    const auto crossing = cross(sphere, {.origin = {}, .direction = direction});
    RC_ASSERT(crossing.has_value());
    RC_ASSERT(crossing->u >= 0 && crossing->u <= 1 && crossing->v >= 0 && crossing->v <= 1);
    const Vec3f normal = unit_normal(geometry, 0, crossing->u, crossing->v);
    RC_ASSERT(largest(abs(to_real(normal) - to_real(direction) / size)) < 1e-6L);
    RC_ASSERT(std::abs(length(to_real(normal)) - 1) < 1e-6L);
  });
}

TEST(UnitNormal, FollowsTheRightHandAtAnySize) {
  for (const float s : {1.0F, 1e-30F, 1e30F, 1e-42F}) {
    const Vec3f corners[3] = {{0, 0, 0}, {s, 0, 0}, {0, s, 0}};
    const TriangleCorners triangle{0, 1, 2};
    const Geometry mesh{TriangleMesh{{corners, 3}, {&triangle, 1}}};
    EXPECT_EQ(unit_normal(mesh, 0, 0, 0), (Vec3f{0, 0, 1}));
    const Parallelogram shape{{0, 0, 0}, {0, s, 0}, {s, 0, 0}};
    EXPECT_EQ(unit_normal(Geometry{Strided<Parallelogram>(&shape, 1)}, 0, 0, 0), (Vec3f{0, 0, -1}));
  }
}

}  // namespace
}  // namespace kerf::test
