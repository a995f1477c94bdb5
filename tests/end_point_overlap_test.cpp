// The end-point overlap against cases worked by hand and against every primitive clipped to every node by another
// method.

#include "kerf/study/end_point_overlap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "kerf/base/error.h"
#include "kerf/base/parallel.h"
#include "tests/support/random.h"
#include "tests/support/random_scene.h"
#include "tests/support/structures.h"

namespace kerf::test {
namespace {

using Point = std::array<double, 2>;

/// a * x + b * y <= c.
struct HalfPlane {
  double a, b, c;
  double past(Point p) const { return a * p[0] + b * p[1] - c; }
  double size() const { return std::abs(a) + std::abs(b) + std::abs(c); }
};

/// The area of what several half-planes share: of the corners, where two of their borders meet, in order by angle.
double shared_area(const std::vector<HalfPlane>& planes) {
  std::vector<Point> corners;
  Point middle{0, 0};
  for (size_t i = 0; i < planes.size(); ++i) {
    for (size_t k = i + 1; k < planes.size(); ++k) {
      const HalfPlane &p = planes[i], &q = planes[k];
      const double across = p.a * q.b - q.a * p.b;
      if (std::abs(across) < 1e-14 * p.size() * q.size()) continue;
      const Point at{(p.c * q.b - q.c * p.b) / across, (p.a * q.c - q.a * p.c) / across};
      const bool is_within = std::all_of(
          planes.begin(), planes.end(), [&](const HalfPlane& plane) { return plane.past(at) <= 1e-11 * plane.size(); });
      if (!is_within) continue;
      corners.push_back(at);
      middle = {middle[0] + at[0], middle[1] + at[1]};
    }
  }
  if (corners.size() < 3) return 0;
  for (double& x : middle) x /= static_cast<double>(corners.size());
  const auto angle = [&](Point p) { return std::atan2(p[1] - middle[1], p[0] - middle[0]); };
  std::sort(corners.begin(), corners.end(), [&](Point p, Point q) { return angle(p) < angle(q); });
  double twice = 0;
  for (size_t i = 0; i < corners.size(); ++i) {
    const Point p = corners[i], q = corners[(i + 1) % corners.size()];
    twice += (p[0] - middle[0]) * (q[1] - middle[1]) - (q[0] - middle[0]) * (p[1] - middle[1]);
  }
  return std::abs(twice) / 2;
}

/// corner + x * u + y * v for x, y >= 0, and x + y <= 1 or both <= 1.
struct Piece {
  Vec3d corner, u, v;
  bool is_triangle;

  double area() const {
    const Vec3d twice = cross(u, v);
    return std::sqrt(dot(twice, twice)) * (is_triangle ? 0.5 : 1);
  }
  double area_within(const Box3f& box) const {
    std::vector<HalfPlane> planes{{-1, 0, 0}, {0, -1, 0}};
    if (is_triangle) planes.push_back({1, 1, 1});
    if (!is_triangle) planes.insert(planes.end(), {{1, 0, 1}, {0, 1, 1}});
    for (uint32_t axis = 0; axis < 3; ++axis) {
      planes.push_back({u[axis], v[axis], box.upper[axis] - corner[axis]});
      planes.push_back({-u[axis], -v[axis], corner[axis] - box.lower[axis]});
    }
    // A border without a direction holds everywhere or nowhere.
    for (size_t i = planes.size(); i-- > 0;) {
      if (planes[i].a != 0 || planes[i].b != 0) continue;
      if (planes[i].c < 0) return 0;
      planes.erase(planes.begin() + static_cast<std::ptrdiff_t>(i));
    }
    const Vec3d twice = cross(u, v);
    return shared_area(planes) * std::sqrt(dot(twice, twice));
  }
};

std::vector<std::pair<LeafSlot, Piece>> pieces_of(const Scene& scene) {
  std::vector<std::pair<LeafSlot, Piece>> pieces;
  for (uint32_t g = 0; g < scene.geometries().size(); ++g) {
    const Geometry& geometry = scene.geometries()[g];
    for (uint32_t p = 0; p < primitive_count(geometry); ++p) {
      if (find_defect(geometry, p) != Defect::none || is_degenerate(geometry, p)) continue;
      if (const auto* mesh = std::get_if<TriangleMesh>(&geometry.shapes)) {
        const Triangle t = mesh->triangle(p);
        const Vec3d a = to_double(t.a);
        pieces.push_back({{g, p}, {a, to_double(t.b) - a, to_double(t.c) - a, true}});
      } else if (const auto* shapes = std::get_if<Strided<Parallelogram>>(&geometry.shapes)) {
        const Parallelogram s = (*shapes)[p];
        pieces.push_back({{g, p}, {to_double(s.corner), to_double(s.u), to_double(s.v), false}});
      }
    }
  }
  return pieces;
}

/// By the definition: every node against every primitive.
double brute_force_overlap(const Scene& scene) {
  struct Node {
    Box3f bounds;
    uint32_t depth;
    double cost;
    std::set<std::pair<uint32_t, uint32_t>> held;
  };
  std::vector<Node> nodes;
  scene.structure().visit_nodes([&](const NodeView& view) {
    nodes.push_back({view.bounds, view.depth, view.is_leaf ? static_cast<double>(view.slots.size()) : 1, {}});
    for (size_t i = nodes.size(), above = view.depth + 1; i-- > 0;) {  // itself, its parent, its parent's parent, ...
      if (nodes[i].depth >= above) continue;
      above = nodes[i].depth;
      for (const LeafSlot& slot : view.slots) nodes[i].held.insert({slot.geometry(), slot.primitive});
    }
  });
  double area = 0, sum = 0;
  for (const auto& [slot, piece] : pieces_of(scene)) {
    area += piece.area();
    for (const Node& node : nodes) {
      if (!node.held.contains({slot.geometry(), slot.primitive})) sum += node.cost * piece.area_within(node.bounds);
    }
  }
  return area > 0 ? sum / area : 0;
}

class EveryOverlap : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Menu, EveryOverlap, testing::ValuesIn(traceable_pipelines()),
                         [](const auto& entry) { return test_name(entry.param); });

TEST_P(EveryOverlap, IsThatOfBruteForce) {
  for (const uint32_t count : {1U, 2U, 9U, 150U, 400U}) {
    const RandomTriangles triangles(count, count);
    Random random(count);
    std::vector<Parallelogram> shapes;
    std::vector<Sphere> spheres;
    for (uint32_t i = 0; i < count / 4; ++i) {
      shapes.push_back({8.0F * random.vector(), 3.0F * random.vector(), random.vector()});
      spheres.push_back({8.0F * random.vector(), 1});
    }
    // Along the axes, so that they lie in the faces of boxes.
    shapes.push_back({{-5, -5, 1}, {10, 0, 0}, {0, 10, 0}});
    shapes.push_back({{-5, 1, -5}, {10, 0, 0}, {0, 0, 10}});
    Scene scene;
    scene.add(triangles.geometry());
    scene.add(Strided<Sphere>(spheres.data(), spheres.size()));
    scene.add(Strided<Parallelogram>(shapes.data(), shapes.size()));
    scene.build({.structure = GetParam()});
    const double expected = brute_force_overlap(scene);
    EXPECT_NEAR(end_point_overlap(scene), expected, 1e-9 * (1 + expected)) << count;
  }
}

TEST_P(EveryOverlap, EmptySceneHasNone) {
  Scene scene;
  scene.build({.structure = GetParam()});
  EXPECT_EQ(end_point_overlap(scene), 0);
}

TEST(EndPointOverlap, BruteForceTestsAllInOneLeafAndSoHasNone) {
  const RandomTriangles triangles(100);
  Scene scene;
  scene.add(triangles.geometry());
  scene.build({.structure = "brute_force"});
  EXPECT_EQ(end_point_overlap(scene), 0);
}

/// Corners three by three.
struct Corners {
  std::vector<Vec3f> vertices;
  std::vector<TriangleCorners> triangles;

  explicit Corners(std::vector<Vec3f> from) : vertices(std::move(from)) {
    for (uint32_t i = 0; i + 2 < vertices.size(); i += 3) triangles.push_back({i, i + 1, i + 2});
  }
};

double overlap_of(const Corners& corners, const char* structure = "sweep_sah(leaf=1)") {
  Scene scene;
  scene.add(TriangleMesh{corners.vertices, corners.triangles});
  scene.build({.structure = structure});
  return end_point_overlap(scene);
}

// One lies in z = 0 over the square [0, 4]^2, below x + y = 4: area 8. The other stands in x = 1 on it, from y = 1 to 3
// and z = -1 to 1: area 2. The first one's box has no height and meets the second one nowhere but along a line. The
// second one's box has no depth either.
TEST(EndPointOverlap, FlatBoxesThatCrossHaveNone) {
  EXPECT_EQ(overlap_of(Corners({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, -1}, {1, 3, -1}, {1, 1, 1}})), 0);
}

// The first lies in the plane y = x, from x = 0 to 2 and z = 0 to 2, an upright half of a rectangle of sides 2 sqrt(2)
// and 2: area 2 sqrt(2). Its box is [0, 2]^3. The second lies in z = 1 with corners (1, 0), (3, 0), (1, 2): area 2; its
// box has no height, and the first crosses it along a line. Of the second, x <= 2 lies in the first one's box: all but
// the triangle (2, 0), (3, 0), (2, 1) of area 1/2.
TEST(EndPointOverlap, TwoTrianglesThatCross) {
  const Corners two({{0, 0, 0}, {2, 2, 0}, {0, 0, 2}, {1, 0, 1}, {3, 0, 1}, {1, 2, 1}});
  EXPECT_NEAR(overlap_of(two), 1.5 / (2 + 2 * std::sqrt(2.0)), 1e-12);
  EXPECT_EQ(overlap_of(two, "brute_force"), 0);
}

// Both of the first pair are in one leaf of two slots, which the third reaches into by half: 2 * 1/2 of its own area,
// which is as large as that of each of the others. The third's box is flat, and they only touch its plane.
TEST(EndPointOverlap, LeavesCountTheirSlots) {
  const Corners three(
      {{0, 0, 0}, {2, 0, 2}, {0, 2, 0}, {0, 0, 0}, {2, 0, 2}, {0, 2, 0}, {-2, 0, 1}, {2, 0, 1}, {-2, 2, 1}});
  Scene scene;
  scene.add(TriangleMesh{three.vertices, three.triangles});
  scene.build({.structure = "object_median(leaf=2)"});
  ASSERT_EQ(scene.report().largest_leaf, 2U);
  EXPECT_NEAR(end_point_overlap(scene), brute_force_overlap(scene), 1e-12);
  // Area of the pair: 2 sqrt(2) each; of the third: 4, of which 0 <= x <= 2 is a quarter.
  EXPECT_NEAR(end_point_overlap(scene), 2 * 1.0 / (4 + 4 * std::sqrt(2.0)), 1e-12);
}

TEST(EndPointOverlap, LeavesThatLieApartHaveNone) {
  std::vector<Vec3f> vertices;
  for (int i = 0; i < 64; ++i) {
    const int column = i % 4, row = i / 4 % 4, layer = i / 16;
    const Vec3f at = 3.0F * Vec3f{static_cast<float>(column), static_cast<float>(row), static_cast<float>(layer)};
    vertices.insert(vertices.end(), {at, at + Vec3f{1, 0, 1}, at + Vec3f{0, 1, 1}});
  }
  EXPECT_EQ(overlap_of(Corners(vertices)), 0);
}

TEST(EndPointOverlap, IsTheSameForAnyNumberOfThreads) {
  const RandomTriangles triangles(5000);
  Scene scene;
  scene.add(triangles.geometry());
  scene.build();
  double one = 0;
  with_threads(1, [&] { one = end_point_overlap(scene); });
  EXPECT_GT(one, 0);
  for (const int threads : {2, 3, 8}) {
    with_threads(threads, [&] { EXPECT_EQ(end_point_overlap(scene), one) << threads; });
  }
}

TEST(EndPointOverlap, DoesNotDependOnTheUnit) {
  for (const float unit : {1e-30F, 1e-6F, 1e30F}) {
    RandomTriangles triangles(300), scaled(300);
    for (Vec3f& vertex : scaled.vertices) vertex = vertex * unit;
    Scene scene, other;
    scene.add(triangles.geometry());
    other.add(scaled.geometry());
    scene.build({.structure = "object_median"});
    other.build({.structure = "object_median"});
    EXPECT_NEAR(end_point_overlap(other) / end_point_overlap(scene), 1, 1e-2) << unit;  // vertices are rounded anew
  }
}

// Every one lies in every node and in every leaf: N - 1 of N slots, and all inner nodes but those above it.
TEST(EndPointOverlap, TakesManyInOnePlace) {
  constexpr uint32_t kDepth = 16;
  const Corners one({{0, 0, 0}, {1, 0, 0}, {0, 1, 1}});
  const std::vector<TriangleCorners> same(size_t{1} << kDepth, one.triangles[0]);
  Scene scene;
  scene.add(TriangleMesh{one.vertices, same});
  scene.build({.structure = "object_median(leaf=1)"});
  ASSERT_EQ(scene.report().depth, kDepth);
  const auto slots = static_cast<double>(same.size());
  EXPECT_NEAR(end_point_overlap(scene), 2 * (slots - 1) - kDepth, 1e-6);
}

TEST(EndPointOverlap, StopsAtItsLimit) {
  const RandomTriangles triangles(2000);
  Scene scene;
  scene.add(triangles.geometry());
  scene.build();
  const std::atomic<bool> cancelled = true;
  WorkLimit limit;
  limit.cancelled = &cancelled;
  EXPECT_THROW(end_point_overlap(scene, limit), Error);
  WorkLimit small;
  small.bytes = 1000;
  EXPECT_THROW(end_point_overlap(scene, small), Error);
  Scene unbuilt;
  EXPECT_THROW(end_point_overlap(unbuilt), Error);
}

}  // namespace
}  // namespace kerf::test
