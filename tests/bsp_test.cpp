// The BSP tree: areas of convex cells and a tree worked by hand, planes of faces, caps, faults.

#include <gtest/gtest.h>

#include <cmath>

#include "kerf/build/bsp_sah.h"
#include "kerf/build/convex_cell.h"
#include "kerf/scene/scene.h"
#include "kerf/trace/trace_bsp.h"
#include "tests/support/meshes.h"
#include "tests/support/random.h"
#include "tests/support/random_scene.h"

namespace kerf::test {
namespace {

BspPlane plane_through(Vec3f direction, Vec3d point) {
  const Vec3d d = to_double(direction);
  BspPlane plane{to_float(d / std::sqrt(dot(d, d))), 0};
  plane.offset = dot(to_double(plane.normal), point);
  return plane;
}

void expect_areas(const ConvexCell& cell, const BspPlane& plane, double below, double above) {
  const ConvexCell::Areas areas = cell.areas_after(plane);
  EXPECT_NEAR(areas.below, below, 1e-6);
  EXPECT_NEAR(areas.above, above, 1e-6);
  const ConvexCell::Parts parts = cell.cut(plane);
  EXPECT_NEAR(parts.below.area(), below, 1e-6);
  EXPECT_NEAR(parts.above.area(), above, 1e-6);
}

TEST(ConvexCell, HasTheAreasWorkedByHand) {
  const ConvexCell cube(Box3f{{0, 0, 0}, {2, 2, 2}});
  EXPECT_EQ(cube.area(), 24);
  expect_areas(cube, plane_through({1, 0, 0}, {0.5, 0, 0}), 12, 20);
  // Along a diagonal, through four corners: two triangles of 2, two squares of 4 and a lid of 4 sqrt(2) on each side.
  const BspPlane diagonal = plane_through({1, 1, 0}, {1, 1, 0});
  expect_areas(cube, diagonal, 12 + 4 * std::sqrt(2), 12 + 4 * std::sqrt(2));
  // A corner: three triangles of 1/2 and a lid of sqrt(3)/2.
  expect_areas(cube, plane_through({1, 1, 1}, {1, 0, 0}), 1.5 + std::sqrt(3) / 2, 22.5 + std::sqrt(3) / 2);
  // The prism below the diagonal, halved through its edge at the origin: legs of 2, sqrt(2) and sqrt(2).
  const ConvexCell prism = cube.cut(diagonal).below;
  const double half = 2 * 1 + 2 * (2 + std::sqrt(2) + std::sqrt(2));
  expect_areas(prism, plane_through({1, -1, 0}, {0, 0, 0}), half, half);
  // A plane beside it takes nothing; one along a face leaves a flat cell of two sides below, nothing above.
  expect_areas(cube, plane_through({1, 0, 0}, {3, 0, 0}), 24, 0);
  expect_areas(cube, plane_through({0, 0, 1}, {0, 0, 0}), 8, 24);
  expect_areas(cube, plane_through({0, 0, 1}, {0, 0, 2}), 24, 0);
}

TEST(ConvexCell, AFlatBoxHasTwoSides) {
  const ConvexCell flat(Box3f{{0, 0, 1}, {4, 2, 1}});
  EXPECT_EQ(flat.area(), 16);
  const ConvexCell::Parts parts = flat.cut(plane_through({1, 0, 0}, {1, 0, 0}));
  EXPECT_NEAR(parts.below.area(), 4, 1e-12);
  EXPECT_NEAR(parts.above.area(), 12, 1e-12);
}

TEST(ConvexCell, AreasBeforeAndAfterCutsAgreeHoweverManyTheyAre) {
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    ConvexCell cell(Box3f{{-1, -1, -1}, {1, 1, 1}});
    for (int k = 0; k < 25 && cell.area() > 1e-6; ++k) {
      const auto [lower, upper] = cell.bounds();
      Vec3d inside = (lower + upper) * 0.5;
      const BspPlane plane = plane_through(random.vector(), inside);
      const ConvexCell::Areas areas = cell.areas_after(plane);
      ConvexCell::Parts parts = cell.cut(plane);
      ASSERT_NEAR(areas.below, parts.below.area(), 1e-9 + 1e-9 * cell.area());
      ASSERT_NEAR(areas.above, parts.above.area(), 1e-9 + 1e-9 * cell.area());
      ASSERT_GE(areas.below + areas.above, cell.area() * (1 - 1e-9));
      cell = random.below(2) == 0 ? parts.below : parts.above;
    }
  }
}

/// Two triangles across the x axis in [0,4] x [0,4] x [0,4], at x = 1 and x = 3, and the plane x + y = 4 between what
/// is low and what is high in y: below it triangle 0 for small y, above it triangle 1 for large y.
class ThreeNodes : public testing::Test {
 protected:
  ThreeNodes() {
    const BspPlane plane = plane_through({1, 1, 0}, {2, 2, 0});
    tracer_.tree.nodes = {{plane.normal, 1, plane.offset, 0, BspPlane::kOblique}, {{}, 0, 0, 1}, {{}, 1, 0, 1}};
    tracer_.tree.bounds = {{0, 0, 0}, {4, 4, 4}};
    tracer_.tree.cells.assign(3, {tracer_.tree.bounds, 1});
    tracer_.tree.slots = {{0, 0}, {0, 1}};
    tracer_.tree.slack = 1e-6;
    tracer_.geometries = geometries_;
    EXPECT_EQ(find_fault(tracer_.tree, geometries_), std::nullopt);
  }

  void expect(const Ray& ray, uint32_t primitive, uint64_t nodes, uint64_t primitives) {
    TraceCounts counts;
    EXPECT_EQ(bsp_table().closest_counted(&tracer_, ray, counts).primitive, primitive);
    EXPECT_EQ(counts.nodes, nodes);
    EXPECT_EQ(counts.primitives, primitives);
    EXPECT_EQ(counts.boxes, 1U);
    EXPECT_EQ(bsp_table().any(&tracer_, ray), primitive != kNone);
  }

  std::vector<Vec3f> vertices_ = {{1, 0, 0}, {1, 2, 0}, {1, 0, 4}, {3, 4, 4}, {3, 2, 4}, {3, 4, 0}};
  std::vector<TriangleCorners> triangles_ = {{0, 1, 2}, {3, 4, 5}};
  Geometry geometry_{TriangleMesh{vertices_, triangles_}};
  std::span<const Geometry> geometries_{&geometry_, 1};
  BspTracer tracer_;
};

TEST_F(ThreeNodes, AreVisitedAsByHand) {
  expect({.origin = {-1, 0.5F, 0.5F}, .direction = {1, 0, 0}}, 0, 2, 1);      // a hit before the plane ends it
  expect({.origin = {-1, 0.5F, 3.5F}, .direction = {1, 0, 0}}, kNone, 3, 2);  // a miss on either side
  expect({.origin = {5, 3.5F, 3.5F}, .direction = {-1, 0, 0}}, 1, 2, 1);      // from above: the other side first
  expect({.origin = {5, 0.5F, 0.5F}, .direction = {-1, 0, 0}}, 0, 3, 2);
  expect({.origin = {0, 1, -1}, .direction = {0, 0, 1}}, kNone, 2, 1);                    // along the plane, below it
  expect({.origin = {2, 2, -1}, .direction = {0, 0, 1}}, kNone, 3, 2);                    // in the plane: both
  expect({.origin = {-1, 5, 0.5F}, .direction = {1, 0, 0}}, kNone, 0, 0);                 // beside everything
  expect({.origin = {-1, 0.5F, 0.5F}, .direction = {1, 0, 0}, .t_max = 1}, kNone, 2, 1);  // ends before the plane
}

TEST_F(ThreeNodes, FaultsAreFound) {
  const auto fault_after = [&](auto&& damage) {
    BspTree tree = tracer_.tree;
    damage(tree);
    return find_fault(tree, geometries_);
  };
  EXPECT_EQ(fault_after([](BspTree&) {}), std::nullopt);
  EXPECT_NE(fault_after([](BspTree& t) { t.nodes[0].offset = 9; }), std::nullopt) << "the plane past triangle 1";
  EXPECT_NE(fault_after([](BspTree& t) { t.nodes[0].offset = std::nan(""); }), std::nullopt);
  EXPECT_NE(fault_after([](BspTree& t) { t.nodes[0].normal = -t.nodes[0].normal; }), std::nullopt);
  EXPECT_NE(fault_after([](BspTree& t) { t.nodes[0].normal = 2.0F * t.nodes[0].normal; }), std::nullopt);
  EXPECT_NE(fault_after([](BspTree& t) { t.nodes[0].kind = BspPlane::kAcrossX; }), std::nullopt);
  EXPECT_NE(fault_after([](BspTree& t) { t.nodes[0].kind = 5; }), std::nullopt);
  EXPECT_NE(fault_after([](BspTree& t) { t.nodes[0].kind = BspNode::kLeaf; }), std::nullopt);
  EXPECT_NE(fault_after([](BspTree& t) { t.nodes[0].first = 0; }), std::nullopt);
  EXPECT_NE(fault_after([](BspTree& t) { t.nodes[0].first = 3; }), std::nullopt);
  EXPECT_NE(fault_after([](BspTree& t) { t.nodes[0].count = 1; }), std::nullopt);
  EXPECT_NE(fault_after([](BspTree& t) { std::swap(t.nodes[1].first, t.nodes[2].first); }), std::nullopt);
  EXPECT_NE(fault_after([](BspTree& t) { t.nodes[1].count = 0; }), std::nullopt);
  EXPECT_NE(fault_after([](BspTree& t) { t.nodes[1].count = 3; }), std::nullopt);
  EXPECT_NE(fault_after([](BspTree& t) { t.nodes[2].first = 0; }), std::nullopt);
  EXPECT_NE(fault_after([](BspTree& t) { t.slots[1].primitive = 2; }), std::nullopt);
  EXPECT_NE(fault_after([](BspTree& t) { t.slots[1].geometry_bits = LeafSlot::kRepeated; }), std::nullopt);
  EXPECT_NE(fault_after([](BspTree& t) { t.slots.push_back({0, 0}); }), std::nullopt);
  EXPECT_NE(fault_after([](BspTree& t) { t.cells.pop_back(); }), std::nullopt);
  EXPECT_NE(fault_after([](BspTree& t) { t.cells[0].bounds.upper.x = 3; }), std::nullopt);
  EXPECT_NE(fault_after([](BspTree& t) { t.slack = -1; }), std::nullopt);
  EXPECT_NE(fault_after([](BspTree& t) { t.nodes.clear(), t.cells.clear(), t.slots.clear(); }), std::nullopt);
  const auto twice = [](BspTree& t) {
    t.slots = {{0, 0}, {0, 0}, {0, 1}};
    t.nodes[1].count = 2;
    t.nodes[2].first = 2;
  };
  EXPECT_NE(fault_after(twice), std::nullopt);
}

TEST(BspTree, CostOfTheCells) {
  BspTree tree;
  EXPECT_EQ(sah_cost(tree), 0);
  tree.nodes = {{{1, 0, 0}, 1, 0, 0, BspPlane::kAcrossX}, {{}, 0, 0, 2}, {{}, 2, 0, 0}};
  tree.cells = {{{}, 10}, {{}, 4}, {{}, 8}};
  EXPECT_DOUBLE_EQ(sah_cost(tree), 1 + 2 * 4 / 10.0);
}

std::vector<Reference> references_of(const Geometry& geometry) { return make_references({&geometry, 1}).references; }

size_t oblique_planes(const BspTree& tree) {
  size_t count = 0;
  for (const BspNode& node : tree.nodes) count += node.kind == BspPlane::kOblique ? 1 : 0;
  return count;
}

TEST(BspSah, ADiagonalWallIsOnePlane) {
  // A tilted quad of two triangles in a cube of its own: its plane has both triangles on one side and nothing on the
  // other, and no plane across an axis is worth its cost.
  const std::vector<Vec3f> vertices = {{0, 0, 0}, {4, 4, 0}, {4, 4, 4}, {0, 0, 4}};
  const std::vector<TriangleCorners> triangles = {{0, 1, 2}, {0, 2, 3}};
  const Geometry geometry{TriangleMesh{vertices, triangles}};
  const BspTree tree =
      build_bsp_sah({&geometry, 1}, references_of(geometry), {.axis_cost = 0.25, .oblique_cost = 0.25});
  EXPECT_EQ(find_fault(tree, {&geometry, 1}), std::nullopt);
  ASSERT_GE(tree.nodes.size(), 3U);
  EXPECT_EQ(tree.nodes[0].kind, BspPlane::kOblique);
  EXPECT_NEAR(tree.nodes[0].offset, 0, 1e-6);
  EXPECT_NEAR(std::abs(tree.nodes[0].normal.x), std::sqrt(0.5), 1e-6);
}

TEST(BspSah, FacesMakeTiltedThingsCheaper) {
  const PlacedSolid solid = place(cog(12), 3, {1, 2, 3});
  const Geometry geometry{solid.mesh()};
  const std::vector<Reference> references = references_of(geometry);
  const BspTree with = build_bsp_sah({&geometry, 1}, references),
                without = build_bsp_sah({&geometry, 1}, references, {.faces = 0});
  EXPECT_EQ(find_fault(with, {&geometry, 1}), std::nullopt);
  EXPECT_EQ(find_fault(without, {&geometry, 1}), std::nullopt);
  EXPECT_GT(oblique_planes(with), 0U);
  EXPECT_EQ(oblique_planes(without), 0U);
  EXPECT_LT(sah_cost(with), sah_cost(without));
}

TEST(BspSah, KeepsTheCapAndTheDepth) {
  const RandomTriangles triangles(2000);
  const Geometry geometry = triangles.geometry();
  const std::vector<Reference> references = references_of(geometry);
  size_t before = 0;
  for (const double cap : {1.0, 1.5, 4.0}) {
    const BspTree tree = build_bsp_sah({&geometry, 1}, references, {.cap = cap});
    EXPECT_EQ(find_fault(tree, {&geometry, 1}), std::nullopt);
    EXPECT_LE(static_cast<double>(tree.slots.size()), cap * 2000);
    EXPECT_GT(tree.slots.size(), before);
    before = tree.slots.size();
  }
  EXPECT_EQ(build_bsp_sah({&geometry, 1}, references, {.cap = 1}).slots.size(), 2000U);
  Scene scene;
  scene.add(geometry);
  EXPECT_EQ(scene.build({.structure = "bsp_sah(depth=5)"}).depth, 5U);
}

TEST(BspSah, SeparatesSpheresAndNearlyAxisAlignedFaces) {
  // Normals that differ from an axis by less than a float tells are planes like any other.
  Random random(3);
  std::vector<Sphere> spheres;
  std::vector<Parallelogram> shapes;
  for (int i = 0; i < 200; ++i) {
    spheres.push_back({10.0F * random.vector(), 0.3F});
    const float tilt = 1e-5F * random.unit();
    shapes.push_back({10.0F * random.vector(), {4, tilt, 0}, {0, tilt, 3}});
  }
  const std::vector<Geometry> geometries = {{Strided<Sphere>(spheres.data(), spheres.size())},
                                            {Strided<Parallelogram>(shapes.data(), shapes.size())}};
  const BspTree tree = build_bsp_sah(geometries, make_references(geometries).references);
  EXPECT_EQ(find_fault(tree, geometries), std::nullopt);
  for (const BspNode& node : tree.nodes) EXPECT_LE(node.count, 8U);
}

}  // namespace
}  // namespace kerf::test
