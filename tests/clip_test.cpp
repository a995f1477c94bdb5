// Clipped boxes: nothing of the primitive left out, nothing to spare, judged in long double.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "kerf/geometry/clip.h"
#include "kerf/geometry/geometry.h"
#include "kerf/references/clipper.h"
#include "tests/support/exact.h"
#include "tests/support/property.h"
#include "tests/support/random.h"

namespace kerf::test {
namespace {

constexpr float kInfinity = Box3f::kInfinity;
constexpr Box3f kEverywhere = {{-kInfinity, -kInfinity, -kInfinity}, {kInfinity, kInfinity, kInfinity}};

float ulp(float x) { return next_above(std::abs(x)) - std::abs(x); }

Box3f box_of(Vec3f p, Vec3f q) { return {min(p, q), max(p, q)}; }

std::array<Vec3d, 3> in_double(const Triangle& t) { return {to_double(t.a), to_double(t.b), to_double(t.c)}; }
std::array<Vec3r, 3> in_real(const Triangle& t) { return {to_real(t.a), to_real(t.b), to_real(t.c)}; }

Real reach_of(const Triangle& t) { return largest(max(max(abs(t.a), abs(t.b)), abs(t.c))); }

/// The box must hold all of `exact`, which is itself right to `blur`, and stick out by no more than `spare` and two
/// ulps.
void check_tight(const Box3f& box, const ExactBox& exact, const Box3f& cell, Real blur, Real spare) {
  if (exact.is_empty()) return;
  RC_ASSERT(!box.is_empty());
  RC_ASSERT(cell.contains(box));
  for (uint32_t axis = 0; axis < 3; ++axis) {
    RC_ASSERT(box.lower[axis] <= exact.lower[axis] + blur);
    RC_ASSERT(box.upper[axis] >= exact.upper[axis] - blur);
    RC_ASSERT(exact.lower[axis] - box.lower[axis] <= spare + 2 * ulp(box.lower[axis]));
    RC_ASSERT(box.upper[axis] - exact.upper[axis] <= spare + 2 * ulp(box.upper[axis]));
  }
}

Triangle draw_triangle() {
  Triangle t{draw_vector(), draw_vector(), draw_vector()};
  const int form = draw_int(0, 3);
  if (form == 1) t.c = t.a + draw_share() * (t.b - t.a) + 1e-5F * t.c;  // sliver
  if (form == 2) t.a.z = t.b.z = t.c.z;                                 // flat
  if (form == 3) t.b.y = t.a.y;                                         // an edge along a plane
  const float scale = std::ldexp(1.0F, draw_int(-60, 60));
  return {t.a * scale, t.b * scale, t.c * scale};
}

/// A cell around a point of the triangle, so that most cells cut it.
Box3f draw_cell(const Triangle& t) {
  const float u = draw_share(), v = draw_share() * (1 - u), size = static_cast<float>(reach_of(t));
  const Vec3f inside = t.a + u * (t.b - t.a) + v * (t.c - t.a);
  return box_of(inside + draw_vector() * (size * draw_share()), inside + draw_vector() * (size * draw_share()));
}

TEST(ClipTriangle, HoldsTheWholePartAndLittleElse) {
  int cut = 0;
  check_property(20000, [&] {
    const Triangle t = draw_triangle();
    RC_PRE(reach_of(t) > 0);
    const Box3f cell = draw_cell(t);
    const Box3f box = clipped_bounds(in_double(t), cell);
    const ExactBox exact = clip_exactly(in_real(t), cell);
    check_tight(box, exact, cell, 0x1p-57L * reach_of(t), 0x1p-42L * reach_of(t));
    cut += exact.is_empty() ? 0 : 1;
  });
  EXPECT_GT(cut, 5000);
}

TEST(ClipTriangle, HoldsEveryPointSampled) {
  check_property(2000, [] {
    const Triangle t = draw_triangle();
    const Box3f cell = draw_cell(t), box = clipped_bounds(in_double(t), cell);
    const auto [a, b, c] = in_real(t);
    const Real blur = 0x1p-60L * reach_of(t);
    for (int i = 0; i < 20; ++i) {
      Real u = draw_share(), v = draw_share();
      if (u + v > 1) u = 1 - u, v = 1 - v;
      const Vec3r p = a + u * (b - a) + v * (c - a);
      if (!is_inside(cell, p)) continue;
      for (uint32_t axis = 0; axis < 3; ++axis) {
        RC_ASSERT(box.lower[axis] <= p[axis] + blur && p[axis] - blur <= box.upper[axis]);
      }
    }
  });
}

/// A side 0 .. x against a plane where the exact cut lies just past a float f by less than doubles can tell: x * n / d
/// computes to f, so only the allowance for computed corners makes the box reach past it.
struct JustPast {
  float x, low, high, plane, f;
  bool is_above;
};
constexpr JustPast kJustPast[] = {
    {0xfc5a6bp0F, 0xd53a7bp0F, 0x3d52c60000000p0F, 0x1c400b0000000p0F, 0x7440c3p0F, true},    // by 2e-10
    {0x5fe1dap0F, -0xed8bc4p0F, 0x7945bf0000000p0F, 0x28e5b20000000p0F, 0x2055b5p0F, true},   // by 1e-11
    {0x3e05c9p0F, -0x52da0p0F, 0x35cc758000000p0F, 0x254b2f0000000p0F, 0x2afe9dp0F, true},    // by 2e-10
    {0xa75c07p0F, -0x5a9806p0F, 0x2d78518000000p0F, 0x231b7a8000000p0F, 0x8137d5p0F, false},  // by -8e-10
    {0xd9f292p0F, -0xa99d9ap0F, 0x107a42a000000p0F, 0xd05af4000000p0F, 0xac3e5dp0F, false},   // by -2e-11
    {0xa24775p0F, -0xd0b98ep0F, 0x3849f30000000p0F, 0x1625868000000p0F, 0x3fd913p0F, false},  // by -1e-10
};

TEST(ClipTriangle, ReachesPastAFloatThatTheDoubleRoundsTo) {
  for (const JustPast& c : kJustPast) {
    // The side runs from (0, low) to (x, high); kept is what lies below the plane, whose largest x is where they cross.
    const Triangle t{{0, c.low, 0}, {c.x, c.high, 0}, {0, c.low, 1}};
    const Box3f below{{-kInfinity, -kInfinity, -kInfinity}, {kInfinity, c.plane, kInfinity}};
    const Box3f above{{-kInfinity, c.plane, -kInfinity}, {kInfinity, kInfinity, kInfinity}};
    const Real exact = Real{c.x} * (Real{c.plane} - c.low) / (Real{c.high} - c.low);
    if (c.is_above) {
      ASSERT_GT(exact, c.f) << "the case is not what it says";
      EXPECT_GT(clipped_bounds(in_double(t), below).upper.x, c.f);
    } else {
      ASSERT_LT(exact, c.f) << "the case is not what it says";
      EXPECT_LT(clipped_bounds(in_double(t), above).lower.x, c.f);
    }
  }
}

TEST(ClipTriangle, RoundsOutwardWhereTheNearestFloatLiesInside) {
  // x = 1/3 at the cut: the nearest float lies above, so as a lower bound it would be inside; 2/3 likewise below 1.
  const Triangle t{{0, 0, 0}, {1, 3, 0}, {0, 0, 1}};
  for (const float y : {1.0F, 2.0F}) {
    const Real exact = Real{y} / 3;
    const Box3f above = clipped_bounds(in_double(t), {{-9, y, -9}, {9, 9, 9}});
    EXPECT_LT(above.lower.x, exact);
    EXPECT_GT(next_above(above.lower.x), exact) << "no more than one ulp";
    const Box3f below = clipped_bounds(in_double(t), {{-9, -9, -9}, {9, y, 9}});
    EXPECT_GT(below.upper.x, exact);
    EXPECT_LT(next_below(below.upper.x), exact);
  }
}

TEST(ClipTriangle, FlatOnesStayFlat) {
  for (uint32_t axis = 0; axis < 3; ++axis) {
    const uint32_t b = (axis + 1) % 3, c = (axis + 2) % 3;
    for (const float at : {0.0F, 0.1F, -1e30F, 1e-40F}) {
      Triangle t;
      t.a[axis] = t.b[axis] = t.c[axis] = at;
      t.b[b] = 3, t.c[c] = 7;
      Box3f cell = kEverywhere;
      cell.lower[b] = 0.3F, cell.upper[c] = 1.7F;
      const Box3f flat = clipped_bounds(in_double(t), cell);
      EXPECT_EQ(flat.lower[axis], at) << "zero thickness";
      EXPECT_EQ(flat.upper[axis], at) << "zero thickness";
      cell.lower[axis] = cell.upper[axis] = at;
      EXPECT_EQ(clipped_bounds(in_double(t), cell), flat) << "where both sides of the cell are its plane";
    }
  }
}

TEST(ClipTriangle, EmptyExactlyWhereItDoesNotTouch) {
  const Triangle t{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  EXPECT_TRUE(clipped_bounds(in_double(t), {{5, 0, 0}, {6, 1, 1}}).is_empty());
  EXPECT_TRUE(clipped_bounds(in_double(t), {{1, 1, 1e-40F}, {2, 2, 1}}).is_empty());
  EXPECT_TRUE(clipped_bounds(in_double(t), {{2.5F, 2.5F, -1}, {4, 4, 1}}).is_empty())
      << "in its box, past its long side";
  EXPECT_EQ(clipped_bounds(in_double(t), {{4, 0, 0}, {6, 1, 1}}), (Box3f{{4, 0, 0}, {4, 0, 0}})) << "a corner";
  EXPECT_EQ(clipped_bounds(in_double(t), {{1, -2, 0}, {2, 0, 1}}), (Box3f{{1, 0, 0}, {2, 0, 0}})) << "an edge";
  EXPECT_EQ(clipped_bounds(in_double(t), {{1, 1, 0}, {1.5F, 1.5F, 3}}), (Box3f{{1, 1, 0}, {1.5F, 1.5F, 0}}))
      << "its inside";
  EXPECT_EQ(clipped_bounds(in_double(t), kEverywhere), (Box3f{{0, 0, 0}, {4, 4, 0}}));
}

TEST(ClipTriangle, ClipsTheOriginalHoweverOftenItIsCut) {
  check_property(3000, [] {
    const Triangle t = draw_triangle();
    const std::array<Vec3f, 3> corners{t.a, t.b, t.c};
    const TriangleCorners triangle{0, 1, 2};
    const Geometry geometry{TriangleMesh{{corners.data(), 3}, {&triangle, 1}}};
    RC_PRE(!is_degenerate(geometry, 0));
    const std::span<const Geometry> all(&geometry, 1);
    const Clipper clipper = geometry_clipper(all);
    Box3f box = primitive_bounds(geometry, 0);
    Reference piece{box.lower, 0, box.upper, 0};
    for (int cuts = 0; cuts < 20 && !box.is_empty(); ++cuts) {
      const uint32_t axis = largest_axis(box.extent());
      const float middle = center(box, axis);
      const ClippedBoxes parts = clipper(piece, axis, middle);
      const CutBounds of_original = cut_bounds(in_double(t), box, axis, middle);
      RC_ASSERT(parts.below == of_original.below && parts.above == of_original.above);
      RC_ASSERT(!parts.below.is_empty() || !parts.above.is_empty());
      box = parts.below.is_empty() || (!parts.above.is_empty() && draw_int(0, 1) == 0) ? parts.above : parts.below;
      piece.lower = box.lower, piece.upper = box.upper;
      // Twenty cuts later the box is as tight as one cut of the original to it: nothing has added up. What is spare is
      // for sides that hardly lean against a plane, and still below the rounding of a float as large as the triangle
      // reaches.
      check_tight(box, clip_exactly(in_real(t), box), box, 0x1p-57L * reach_of(t), 0x1p-26L * reach_of(t));
    }
  });
}

/// Sides that lean against a cell's plane by a few ulps: there a second cut moves the error of a first one far along.
TEST(ClipTriangle, HoldsPartsCutOffByAPlaneThatASideHardlyLeansAgainst) {
  int cut = 0;
  Random random(3);
  for (int i = 0; i < 100000; ++i) {
    Triangle t{random.vector(), random.vector(), random.vector()};
    t.a.y = 1;
    for (float* y : {&t.b.y, &t.c.y}) *y = 1 + 0x1p-23F * static_cast<float>(random.below(8));
    const float plane = 1 + 0x1p-23F * static_cast<float>(random.below(8));
    Box3f cell{{random.unit(), 0, random.unit()}, {2, plane, 2}};
    if (i % 2 == 0) cell.lower.y = plane, cell.upper.y = 2;
    const ExactBox exact = clip_exactly(in_real(t), cell);
    if (exact.is_empty()) continue;
    ++cut;
    const Box3f box = clipped_bounds(in_double(t), cell);
    for (uint32_t axis = 0; axis < 3; ++axis) {
      ASSERT_LE(box.lower[axis], exact.lower[axis] + 0x1p-38L) << i;
      ASSERT_GE(box.upper[axis], exact.upper[axis] - 0x1p-38L) << i;
    }
  }
  EXPECT_GT(cut, 20000);
}

TEST(ClipTriangle, NeverMakesAMinusZero) {
  const float least = std::numeric_limits<float>::denorm_min();
  const Triangle t{{-least, -3 * least, 0}, {0, 0, 0}, {-least, -3 * least, least}};
  const Box3f box = clipped_bounds(in_double(t), {{-1, -1, -1}, {1, -least, 1}});
  EXPECT_EQ(box.upper.x, 0);
  EXPECT_FALSE(std::signbit(box.upper.x));
}

TEST(ClipParallelogram, HoldsTheWholePartAndLittleElse) {
  check_property(6000, [] {
    const Parallelogram shape{draw_vector(), draw_vector(), draw_vector()};
    const Geometry geometry{Strided<Parallelogram>(&shape, 1)};
    const Vec3f inside = shape.corner + draw_share() * shape.u + draw_share() * shape.v;
    const Box3f cell = box_of(inside + draw_vector() * draw_share(), inside + draw_vector() * draw_share());
    const Vec3r a = to_real(shape.corner), u = to_real(shape.u), v = to_real(shape.v);
    const std::array<Vec3r, 4> corners{a, a + u, a + u + v, a + v};
    check_tight(clipped_bounds(geometry, 0, cell), clip_exactly(corners, cell), cell, 0x1p-56L, 0x1p-46L);
    ExactBox exact;
    for (const Vec3r& p : corners) exact.extend(p);
    check_tight(primitive_bounds(geometry, 0), exact, kEverywhere, 0, 0);
  });
}

TEST(CutTriangle, HoldsBothPartsAndLittleElse) {
  int both = 0;
  check_property(8000, [&] {
    const Triangle t = draw_triangle();
    RC_PRE(reach_of(t) > 0);
    // Of what is left of it, as a piece is cut again, or of all.
    const Box3f cell = draw_int(0, 1) == 0 ? kEverywhere : clipped_bounds(in_double(t), draw_cell(t));
    RC_PRE(!cell.is_empty());
    const auto axis = static_cast<uint32_t>(draw_int(0, 2));
    const Box3f whole = intersected(cell, clipped_bounds(in_double(t), kEverywhere));
    const float position = whole.lower[axis] + draw_share() * (whole.upper[axis] - whole.lower[axis]);
    const CutBounds boxes = cut_bounds(in_double(t), cell, axis, position);
    Box3f below = cell, above = cell;
    below.upper[axis] = position;
    above.lower[axis] = position;
    const ExactBox exact_below = clip_exactly(in_real(t), below), exact_above = clip_exactly(in_real(t), above);
    // A second cut of a side that hardly leans against its plane moves the error of the first far along; the box is
    // then larger than it need be by a few roundings of a float, never smaller.
    const Real spare = (cell == kEverywhere ? 0x1p-42L : 0x1p-21L) * reach_of(t);
    check_tight(boxes.below, exact_below, below, 0x1p-57L * reach_of(t), spare);
    check_tight(boxes.above, exact_above, above, 0x1p-57L * reach_of(t), spare);
    both += exact_below.is_empty() || exact_above.is_empty() ? 0 : 1;
  });
  EXPECT_GT(both, 2000);
}

TEST(CutParallelogramAndSphere, AreTheirTwoCells) {
  check_property(2000, [] {
    const Parallelogram shape{draw_vector(), draw_vector(), draw_vector()};
    const Sphere sphere{draw_vector(), draw_share()};
    for (const Geometry& geometry :
         {Geometry{Strided<Parallelogram>(&shape, 1)}, Geometry{Strided<Sphere>(&sphere, 1)}}) {
      const Box3f cell = primitive_bounds(geometry, 0);
      const auto axis = static_cast<uint32_t>(draw_int(0, 2));
      const float position = cell.lower[axis] + draw_share() * (cell.upper[axis] - cell.lower[axis]);
      const CutBounds boxes = cut_bounds(geometry, 0, cell, axis, position);
      Box3f below = cell, above = cell;
      below.upper[axis] = position;
      above.lower[axis] = position;
      // The same cuts of a whole primitive, so the same floats.
      RC_ASSERT(boxes.below == clipped_bounds(geometry, 0, below));
      RC_ASSERT(boxes.above == clipped_bounds(geometry, 0, above));
    }
  });
}

TEST(ClipSphere, HoldsTheWholePartAndLittleElse) {
  int cut = 0;
  check_property(8000, [&] {
    const float scale = std::ldexp(1.0F, draw_int(-50, 50));
    const Sphere sphere{draw_vector() * (scale * static_cast<float>(draw_int(0, 10))), scale * (0.05F + draw_share())};
    const Vec3f around = sphere.center + draw_vector() * sphere.radius;
    const Box3f cell = box_of(around + draw_vector() * sphere.radius, around + draw_vector() * sphere.radius);
    const Box3f box = clipped_bounds(sphere, cell);
    const ExactBox exact = clip_exactly(sphere, cell);
    const Real size = largest(abs(to_real(sphere.center))) + sphere.radius;
    // Near a pole a circle's radius is the root of a small difference, so the allowance for it is a root too.
    check_tight(box, exact, cell, 0x1p-57L * size, 0x1p-22L * size);
    cut += exact.is_empty() ? 0 : 1;
    const Box3f whole{sphere.center - 2.0F * Vec3f{sphere.radius, sphere.radius, sphere.radius},
                      sphere.center + 2.0F * Vec3f{sphere.radius, sphere.radius, sphere.radius}};
    ExactBox poles;
    poles.extend(to_real(sphere.center) - Vec3r{1, 1, 1} * Real{sphere.radius});
    poles.extend(to_real(sphere.center) + Vec3r{1, 1, 1} * Real{sphere.radius});
    check_tight(clipped_bounds(sphere, whole), poles, whole, 0, 0x1p-44L * size);
  });
  EXPECT_GT(cut, 1500);
}

TEST(ClipSphere, IsTightToTheFloatAwayFromItsPoles) {
  const Sphere sphere{{0, 0, 0}, 5};
  // The float nearest to the root of 5 lies above it, that of 17 below: as bounds both would cut something off.
  const Real low = std::sqrt(Real{5}), high = std::sqrt(Real{17});
  ASSERT_GT(static_cast<float>(low), low);
  ASSERT_LT(static_cast<float>(high), high);
  const Box3f a = clipped_bounds(sphere, {{1, 1, 1}, {2, 4, 9}}), b = clipped_bounds(sphere, {{2, 2, 1}, {3, 3, 9}});
  EXPECT_LT(a.lower.z, low);
  EXPECT_GT(next_above(next_above(a.lower.z)), low);
  EXPECT_GT(b.upper.z, high);
  EXPECT_LT(next_below(next_below(b.upper.z)), high);
  EXPECT_EQ(b.lower.x, 2);
  EXPECT_EQ(b.upper.x, 3);
  EXPECT_EQ(clipped_bounds(sphere, {{1, 1, -9}, {2, 4, -1}}).upper.z, -a.lower.z);
  EXPECT_EQ(clipped_bounds(sphere, {{2, 2, -9}, {3, 3, -1}}).lower.z, -b.upper.z);
}

TEST(ClipSphere, ReachesPastAFloatThatTheDoubleRoundsTo) {
  // At y = 2^-30 the surface is 2^-61 nearer to the centre's plane than at the pole: more than long double's rounding,
  // less than double's.
  const Sphere sphere{{0, 0, 0}, 1};
  const Box3f right = clipped_bounds(sphere, {{0.5F, 0, 0}, {2, 0x1p-30F, 0}});
  EXPECT_LT(right.lower.x, 1);
  EXPECT_EQ(next_above(right.lower.x), 1);
  EXPECT_GE(right.upper.x, 1);
  const Box3f left = clipped_bounds(sphere, {{-2, 0, 0}, {-0.5F, 0x1p-30F, 0}});
  EXPECT_GT(left.upper.x, -1);
  EXPECT_EQ(next_below(left.upper.x), -1);
}

TEST(ClipSphere, CellsWithoutSurfaceAreDropped) {
  const Sphere sphere{{1, 2, 3}, 2};
  EXPECT_TRUE(clipped_bounds(sphere, {{0, 1, 2}, {2, 3, 4}}).is_empty()) << "inside";
  EXPECT_TRUE(clipped_bounds(sphere, {{1, 2, 3}, {1, 2, 3}}).is_empty()) << "the centre";
  EXPECT_TRUE(clipped_bounds(sphere, {{2.5F, 3.5F, 4.5F}, {3, 4, 5}}).is_empty())
      << "outside, in the corner of its box";
  EXPECT_TRUE(clipped_bounds(sphere, {{5, 0, 0}, {6, 9, 9}}).is_empty()) << "outside";
  EXPECT_FALSE(clipped_bounds(sphere, {{3, 1, 2}, {4, 3, 4}}).is_empty()) << "touched at a pole";
  const Box3f slab = clipped_bounds(sphere, {{-9, -9, 3}, {9, 9, 4}});
  EXPECT_EQ(slab.lower.z, 3);
  EXPECT_EQ(slab.upper.z, 4);
  EXPECT_LE(slab.lower.x, -1);
  EXPECT_GE(slab.lower.x, -1.00001F);
}

}  // namespace
}  // namespace kerf::test
