// Parts of primitives that are fixed in their own coordinates: whatever the primitive's vertices do, no point is lost.

#include "kerf/geometry/fragment.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/support/exact.h"
#include "tests/support/moving_things.h"

namespace kerf::test {
namespace {

/// One primitive at rest and moved, as origin + s * along_s + t * along_t in 64 bits of precision.
struct Shape {
  MovingThings things;
  bool is_triangle = true;

  Geometry geometry() const { return things.geometries()[is_triangle ? 0 : 2]; }
  Vec3r at(Real s, Real t) const {
    if (!is_triangle) {
      const Parallelogram& p = things.parallelograms[0];
      return to_real(p.corner) + to_real(p.u) * s + to_real(p.v) * t;
    }
    const Vec3r a = to_real(things.vertices[0]);
    return a + (to_real(things.vertices[1]) - a) * s + (to_real(things.vertices[2]) - a) * t;
  }
  /// The lengths of both sides along an axis, and of the origin.
  Real sides(uint32_t axis) const {
    return std::abs(at(1, 0)[axis] - at(0, 0)[axis]) + std::abs(at(0, 1)[axis] - at(0, 0)[axis]);
  }
};

Shape make_shape(bool is_triangle, Vec3f corner, Vec3f u, Vec3f v) {
  Shape shape;
  shape.is_triangle = is_triangle;
  shape.things.add({corner, corner + u, corner + v});
  shape.things.parallelograms.push_back({corner, u, v});
  return shape;
}

/// A side of a shape: of ordinary length, thousands of times as short, along an axis, or none.
Vec3f draw_side(Random& random, float size) {
  Vec3f side = size * random.vector();
  const uint32_t kind = random.below(8), axis = random.below(3);
  if (kind == 0) side = 1e-4F * side;
  if (kind == 1) side[axis] = 0;
  if (kind == 2) side[axis] = side[(axis + 1) % 3] = 0;
  if (kind == 3) side[axis] *= 1e-6F;
  if (kind == 4 && random.below(8) == 0) side = {};
  return side;
}

Shape draw_shape(Random& random, bool is_triangle, float size, float offset) {
  const Vec3f corner = offset * random.vector(), u = draw_side(random, size);
  // Now and then a sliver.
  const Vec3f v = random.below(4) == 0 ? 0.7F * u + draw_side(random, 1e-5F * size) : draw_side(random, size);
  return make_shape(is_triangle, corner, u, v);
}

/// A place in the triangle or the square.
std::array<Real, 2> draw_place(Random& random, bool is_triangle) {
  Real s = random.below(5) == 0 ? random.below(2) : random.share();
  Real t = random.below(5) == 0 ? random.below(2) : random.share();
  if (is_triangle && s + t > 1) s = 1 - s, t = 1 - t;
  return {s, t};
}

/// A place as near as can be to where the way from an inner to an outer place leaves the cell.
std::array<Real, 2> last_inside(const Shape& shape, const Box3f& cell, std::array<Real, 2> in,
                                std::array<Real, 2> out) {
  for (int i = 0; i < 80; ++i) {
    const std::array<Real, 2> middle = {(in[0] + out[0]) / 2, (in[1] + out[1]) / 2};
    (is_inside(cell, shape.at(middle[0], middle[1])) ? in : out) = middle;
  }
  return in;
}

bool holds(const Box3f& box, Vec3r p, const Shape& shape) {
  for (uint32_t axis = 0; axis < 3; ++axis) {
    const Real rounding = std::ldexp(std::abs(shape.at(0, 0)[axis]) + shape.sides(axis), -58);  // of this test itself
    if (p[axis] < box.lower[axis] - rounding || p[axis] > box.upper[axis] + rounding) return false;
  }
  return true;
}

/// Every place in the cell must be in the box, wherever the shape goes.
void check_cover(Random& random, bool is_triangle, float size, float offset, size_t& cut, size_t& checked) {
  const Shape rest = draw_shape(random, is_triangle, size, offset);
  const Shape moved =
      draw_shape(random, is_triangle, random.below(2) == 0 ? size : 1e3F * size, random.below(2) == 0 ? offset : 0);
  const auto [s, t] = draw_place(random, is_triangle);
  const Vec3r middle = rest.at(s, t);
  Box3f cell;
  for (uint32_t axis = 0; axis < 3; ++axis) {
    cell.lower[axis] = static_cast<float>(middle[axis] - rest.sides(axis) * random.share());
    cell.upper[axis] = static_cast<float>(middle[axis] + rest.sides(axis) * random.share());
  }
  if (!is_inside(cell, middle)) return;  // rounded away
  std::array<FragmentCorner, kMaxFragmentCorners> corners;
  const std::span<const FragmentCorner> fragment(corners.data(), cut_fragment(rest.geometry(), 0, cell, corners));
  cut += fragment.empty() ? 0 : 1;
  const Box3f box = fragment_bounds(moved.geometry(), 0, fragment);
  EXPECT_TRUE(primitive_bounds(moved.geometry(), 0).contains(box));
  for (int i = 0; i < 20; ++i) {
    const std::array<Real, 2> other = draw_place(random, is_triangle);
    const bool inside = is_inside(cell, rest.at(other[0], other[1]));
    const std::array<Real, 2> place = inside ? other : last_inside(rest, cell, {s, t}, other);
    ++checked;
    ASSERT_TRUE(holds(box, moved.at(place[0], place[1]), moved)) << "size " << size << ", offset " << offset;
  }
}

TEST(Fragment, CoversWhatLayInItsCellWhereverVerticesGo) {
  Random random(1);
  size_t cut = 0, checked = 0;
  for (const float size : {1.0F, 1e-3F, 1e6F, 1e30F, 1e-30F, 1e-42F}) {
    for (const float offset : {0.0F, 1.0F, 1e5F}) {
      for (int i = 0; i < 1500; ++i) {
        check_cover(random, i % 2 == 0, size, offset * (size > 1e20F ? 1e28F : 1.0F), cut, checked);
        if (HasFatalFailure()) return;
      }
    }
  }
  EXPECT_GT(cut, 10000U);
  EXPECT_GT(checked, 200000U);
}

TEST(Fragment, HoldsLittleMoreThanItsCellAtRest) {
  Random random(2);
  for (int i = 0; i < 3000; ++i) {
    const Shape shape = draw_shape(random, i % 2 == 0, 1, 1);
    const auto [s, t] = draw_place(random, shape.is_triangle);
    Box3f cell;
    cell.extend(Vec3f{static_cast<float>(shape.at(s, t).x), static_cast<float>(shape.at(s, t).y),
                      static_cast<float>(shape.at(s, t).z)});
    for (uint32_t axis = 0; axis < 3; ++axis) {
      cell.lower[axis] -= 0.3F * random.share();
      cell.upper[axis] += 0.3F * random.share();
    }
    std::array<FragmentCorner, kMaxFragmentCorners> corners;
    const size_t count = cut_fragment(shape.geometry(), 0, cell, corners);
    const Box3f box = fragment_bounds(shape.geometry(), 0, {corners.data(), count});
    for (uint32_t axis = 0; axis < 3; ++axis) {
      const float slack = 0x1p-21F * (1 + static_cast<float>(shape.sides(axis)));
      EXPECT_GE(box.lower[axis], cell.lower[axis] - slack);
      EXPECT_LE(box.upper[axis], cell.upper[axis] + slack);
    }
  }
}

TEST(Fragment, IsWholeWhereNothingOrEverythingIsCutOff) {
  const Shape shape = make_shape(true, {0, 0, 0}, {4, 0, 0}, {0, 4, 0});
  std::array<FragmentCorner, kMaxFragmentCorners> corners;
  EXPECT_EQ(cut_fragment(shape.geometry(), 0, {{0, 0, 0}, {4, 4, 0}}, corners), 0U);
  EXPECT_EQ(cut_fragment(shape.geometry(), 0, {{5, 5, 5}, {6, 6, 6}}, corners), 0U);
  EXPECT_EQ(cut_fragment(shape.geometry(), 0, {{0, 0, 0}, {2, 4, 0}}, corners), 4U);
  EXPECT_EQ(fragment_bounds(shape.geometry(), 0, {}), primitive_bounds(shape.geometry(), 0));
  MovingThings balls;
  balls.spheres = {{{0, 0, 0}, 1}, {{0, 0, 0}, 0}};
  EXPECT_EQ(cut_fragment(balls.geometries()[1], 0, {{-1, -1, -1}, {1, 1, 1}}, corners), 0U);
  EXPECT_EQ(cut_fragment(balls.geometries()[1], 0, {{-0.5F, -0.5F, -0.5F}, {0.5F, 0.5F, 0.5F}}, corners), 0U);
  EXPECT_EQ(cut_fragment(balls.geometries()[1], 0, {{-1, -1, -1}, {1, 1, 0}}, corners), 3U);
  EXPECT_EQ(cut_fragment(balls.geometries()[1], 1, {{0, 0, 0}, {1, 1, 1}}, corners), 0U);
}

TEST(Fragment, OfASphereMovesAndGrowsWithIt) {
  Random random(3);
  size_t cut = 0;
  for (int i = 0; i < 20000; ++i) {
    MovingThings rest, moved;
    rest.spheres.push_back({(i % 3 == 0 ? 1e4F : 1.0F) * random.vector(), random.share()});
    moved.spheres.push_back({(i % 5 == 0 ? 1e4F : 1.0F) * random.vector(), 1e3F * random.share()});
    const auto place = [](const Sphere& s, Vec3r way) { return to_real(s.center) + way * (s.radius / length(way)); };
    const Vec3r way = to_real(random.vector());
    const Vec3r p = place(rest.spheres[0], way), q = place(moved.spheres[0], way);
    Box3f cell;
    for (uint32_t axis = 0; axis < 3; ++axis) {
      cell.lower[axis] = static_cast<float>(p[axis] - (i % 2 == 0 ? 0 : random.share()));
      cell.upper[axis] = static_cast<float>(p[axis] + random.share());
    }
    if (!is_inside(cell, p)) continue;  // rounded away
    std::array<FragmentCorner, kMaxFragmentCorners> corners;
    const size_t count = cut_fragment(rest.geometries()[1], 0, cell, corners);
    cut += count > 0 ? 1 : 0;
    const Box3f box = fragment_bounds(moved.geometries()[1], 0, {corners.data(), count});
    ASSERT_TRUE(is_inside(box, q));
    const Box3f still = fragment_bounds(rest.geometries()[1], 0, {corners.data(), count});
    for (uint32_t axis = 0; axis < 3 && count > 0; ++axis) {
      const float slack = 0x1p-21F * (rest.spheres[0].radius + std::abs(rest.spheres[0].center[axis]));
      EXPECT_GE(still.lower[axis], cell.lower[axis] - slack);
      EXPECT_LE(still.upper[axis], cell.upper[axis] + slack);
    }
  }
  EXPECT_GT(cut, 5000U);
}

TEST(Fragment, StaysFlatInAPlaneOfTheAxes) {
  const Shape rest = make_shape(true, {1, 1, 0.3F}, {3, 1, 0}, {1, 3, 0});
  const Shape moved = make_shape(true, {5, 0.7F, 2}, {3, 0, 1}, {1, 0, 9});
  std::array<FragmentCorner, kMaxFragmentCorners> corners;
  const size_t count = cut_fragment(rest.geometry(), 0, {{1, 1, 0.3F}, {2, 2, 0.3F}}, corners);
  ASSERT_GT(count, 0U);
  const Box3f box = fragment_bounds(moved.geometry(), 0, {corners.data(), count});
  EXPECT_EQ(box.lower.y, 0.7F);
  EXPECT_EQ(box.upper.y, 0.7F);
  EXPECT_LT(half_area(box), 0.5 * half_area(primitive_bounds(moved.geometry(), 0)));
}

}  // namespace
}  // namespace kerf::test
