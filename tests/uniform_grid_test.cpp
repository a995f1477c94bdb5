// The uniform grid: which cells a ray visits and what counts, on a grid worked by hand and against a box test for every
// cell; which cells a primitive gets; its limits.

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "kerf/build/uniform_grid.h"
#include "kerf/scene/scene.h"
#include "kerf/trace/grid_walk.h"
#include "kerf/trace/mailbox.h"
#include "kerf/trace/trace_uniform_grid.h"
#include "kerf/tree/cell_slots.h"
#include "tests/support/error_of.h"
#include "tests/support/four_plates.h"
#include "tests/support/random.h"
#include "tests/support/random_scene.h"

namespace kerf::test {
namespace {

/// Four cells along x in [0, 4] x [-1, 1] x [0, 1], a plate in each, the floor in all.
UniformGrid four_cells(bool with_floor) {
  UniformGrid grid;
  divide(grid, {{0, -1, 0}, {4, 1, 1}}, 1);
  grid.planes[0] = {0, 1, 2, 3, 4};
  grid.offsets = {0};
  for (uint32_t i = 0; i < 4; ++i) {
    grid.slots.push_back({0, i});
    if (with_floor) grid.slots.push_back({LeafSlot::kRepeated, 4});
    grid.offsets.push_back(static_cast<uint32_t>(grid.slots.size()));
  }
  return grid;
}

class FourCells : public testing::Test {
 protected:
  FourCells() : tracer_{four_cells(false), plates_.geometries()} {
    EXPECT_EQ(find_fault(tracer_.grid, plates_.geometries()), std::nullopt);
  }
  Outcome trace(const Ray& ray) const { return closest(uniform_grid_table(true), &tracer_, ray); }

  FourPlates plates_;
  UniformGridTracer<Mailbox> tracer_;
};

TEST_F(FourCells, TheWalkStopsAtTheFirstCellBehindTheHit) {
  const auto [hit, counts] = trace({.origin = {-1, 0.25F, 0.25F}, .direction = {1, 0, 0}});
  EXPECT_EQ(hit.primitive, 0U);
  EXPECT_EQ(hit.t, 1.5F);
  expect_counts(counts, 2, 1, 1);  // the grid and its first cell
  const auto back = trace({.origin = {9, 0.25F, 0.25F}, .direction = {-2, 0, 0}});
  EXPECT_EQ(back.hit.primitive, 3U);
  expect_counts(back.counts, 2, 1, 1);
}

TEST_F(FourCells, ARayThroughAllCellsAndNoTriangleVisitsAll) {
  const auto [hit, counts] = trace({.origin = {-1, 0.75F, 0.75F}, .direction = {1, 0, 0}});
  EXPECT_FALSE(hit);
  expect_counts(counts, 5, 4, 1);
  const auto beside = trace({.origin = {-1, 2, 0.25F}, .direction = {1, 0, 0}});
  EXPECT_FALSE(beside.hit);
  expect_counts(beside.counts, 0, 0, 1);
}

TEST_F(FourCells, TheIntervalCullsCellsAtBothEnds) {
  const Vec3f origin{-1, 0.25F, 0.25F}, x{1, 0, 0};
  const auto third = trace({.origin = origin, .t_min = 3.25F, .direction = x});
  EXPECT_EQ(third.hit.primitive, 2U);
  expect_counts(third.counts, 2, 1, 1);
  const auto none = trace({.origin = origin, .t_min = 2.75F, .direction = x, .t_max = 3.25F});
  EXPECT_FALSE(none.hit);
  expect_counts(none.counts, 3, 2, 1);  // cells 1 and 2
}

TEST_F(FourCells, BothCellsBesideAPlaneAreVisitedByARayInIt) {
  const auto [hit, counts] = trace({.origin = {2, 3, 0.25F}, .direction = {0, -1, 0}});
  EXPECT_FALSE(hit);
  expect_counts(counts, 3, 2, 1);
}

TEST(UniformGrid, APrimitiveInManyCellsIsTestedOnce) {
  const FourPlates plates(true);
  const Ray ray{.origin = {-1, 0.75F, 0.75F}, .direction = {1, 0, 0}};
  const UniformGridTracer<Mailbox> once{four_cells(true), plates.geometries()};
  EXPECT_EQ(find_fault(once.grid, plates.geometries()), std::nullopt);
  expect_counts(closest(uniform_grid_table(true), &once, ray).counts, 5, 5, 1);
  const UniformGridTracer<NoMailbox> again{four_cells(true), plates.geometries()};
  expect_counts(closest(uniform_grid_table(false), &again, ray).counts, 5, 8, 1);
}

/// A box as BoxRay takes it.
struct Sides {
  float values[7];
  explicit Sides(const Box3f& b) : values{b.lower.x, b.lower.y, b.lower.z, 0, b.upper.x, b.upper.y, b.upper.z} {}
};

/// Through the box, some along axes, some from and along its planes, some ending inside.
Ray random_ray(Random& random, const UniformGrid& grid, uint32_t i) {
  const Box3f box = grid.bounds();
  const Vec3f size = box.extent();
  Ray ray;
  for (uint32_t a = 0; a < 3; ++a) {
    ray.origin[a] = box.lower[a] + (3 * random.share() - 1) * size[a];
    ray.direction[a] = random.unit() * (i % 2 == 0 ? 1.0F : size[a] + 1e-3F);
    if (random.below(4) == 0) ray.direction[a] = 0;
    if (random.below(4) == 0) ray.origin[a] = grid.planes[a][random.below(grid.resolution(a) + 1)];
  }
  if (i % 16 == 0) ray.origin = 1000.0F * ray.origin;
  if (i % 16 == 0) ray.direction = 0.5F * (box.lower + box.upper) - ray.origin;
  if (i % 5 == 0) ray.t_min = random.share();
  if (i % 7 == 0) ray.t_max = ray.t_min + random.share();
  return ray;
}

TEST(UniformGrid, TheWalkVisitsExactlyTheCellsThatABoxTestSays) {
  Random random(3);
  const Vec3f sizes[] = {{1, 1, 1}, {100, 1, 0},           {1, 50, 1},
                         {0, 0, 3}, {1e30F, 2e30F, 1e30F}, {1e-40F, 1e-40F, 1e-40F}};
  size_t visited_cells = 0;
  for (const Vec3f size : sizes) {
    UniformGrid grid;
    const Vec3f lower{0.3F * size.x, -0.7F * size.y, -size.z};
    divide(grid, {lower, lower + size}, 300);
    grid.offsets.assign(size_t{grid.resolution(kX)} * grid.resolution(kY) * grid.resolution(kZ) + 1, 0);
    for (uint32_t i = 0; i < 500; ++i) {
      const PreparedRay ray(random_ray(random, grid, i));
      if (!ray.valid) continue;
      const BoxRay box_ray(ray, grid.bounds());
      float entry = 0, last_entry = -Box3f::kInfinity;
      std::set<size_t> expected, visited;
      for (size_t cell = 0; cell < grid.cell_count(); ++cell) {
        const Sides sides(grid.cell_bounds(grid.cell(cell)));
        if (box_ray.enters(sides.values, ray.t_min, ray.t_max, entry)) expected.insert(cell);
      }
      if (box_ray.enters(Sides(grid.bounds()).values, ray.t_min, ray.t_max, entry)) {
        GridWalk(grid, ray, box_ray, entry).run(ray.t_max, [&](size_t cell) {
          EXPECT_TRUE(visited.insert(cell).second) << "twice";
          box_ray.enters(Sides(grid.cell_bounds(grid.cell(cell))).values, ray.t_min, ray.t_max, entry);
          EXPECT_GE(entry, last_entry) << "not the nearest first";
          last_entry = entry;
          return true;
        });
      }
      ASSERT_EQ(visited, expected) << "size " << size.x << ", ray " << i;
      visited_cells += visited.size();
    }
  }
  EXPECT_GT(visited_cells, 5000U);
}

TEST(UniformGrid, ResolutionFollowsTheShape) {
  const auto resolution = [](Vec3f size, double cells) {
    UniformGrid grid;
    divide(grid, {{1, 1, 1}, Vec3f{1, 1, 1} + size}, cells);
    return std::vector<uint32_t>{grid.resolution(kX), grid.resolution(kY), grid.resolution(kZ)};
  };
  EXPECT_EQ(resolution({8, 8, 8}, 1001), (std::vector<uint32_t>{10, 10, 10}));
  EXPECT_EQ(resolution({8, 0, 8}, 101), (std::vector<uint32_t>{10, 1, 10}));
  EXPECT_EQ(resolution({512, 0.25F, 0.25F}, 100.5), (std::vector<uint32_t>{100, 1, 1}));
  EXPECT_EQ(resolution({0, 0, 0}, 100), (std::vector<uint32_t>{1, 1, 1}));
  EXPECT_EQ(resolution({1, 1, 1}, 0.1), (std::vector<uint32_t>{1, 1, 1}));
  EXPECT_EQ(resolution({8, 0, 0}, 1e9), (std::vector<uint32_t>{65536, 1, 1}));
}

UniformGrid build(const std::vector<Geometry>& geometries, const UniformGridOptions& options,
                  const WorkLimit& limit = {}) {
  const std::span<const Geometry> all = geometries;
  UniformGrid grid = build_uniform_grid(make_references(all).references, geometry_clipper(all), options, limit);
  mark_repeated(grid.slots, all);
  return grid;
}

TEST(UniformGrid, CellsGetWhatReachesIntoThemOnly) {
  // Half of a square in 8 x 8 cells: 36 of them lie below or on the diagonal, and 7 touch a corner of it.
  const std::vector<Vec3f> vertices{{0, 0, 0}, {8, 0, 0}, {0, 8, 0}};
  const std::vector<TriangleCorners> corners{{0, 1, 2}};
  const std::vector<Geometry> geometries{{TriangleMesh{std::span(vertices), std::span(corners)}}};
  const UniformGrid clipped = build(geometries, {.density = 64, .cap = 64});
  ASSERT_EQ(clipped.cell_count(), 64U);
  EXPECT_GE(clipped.slots.size(), 36U);
  EXPECT_LE(clipped.slots.size(), 36U + 7);
  EXPECT_EQ(find_fault(clipped, geometries), std::nullopt);
  const UniformGrid boxes = build(geometries, {.density = 64, .cap = 64, .clipped = false});
  EXPECT_EQ(boxes.slots.size(), 64U);
  EXPECT_EQ(find_fault(boxes, geometries), std::nullopt);
  // In a plane between cells, it stands on one side of it only.
  const std::vector<Vec3f> box{{0, 0, 4}, {8, 0, 4}, {0, 8, 4}, {0, 0, 0}, {1, 0, 0},
                               {0, 1, 0}, {0, 0, 8}, {1, 0, 8}, {0, 1, 8}};
  const std::vector<TriangleCorners> three{{0, 1, 2}, {3, 4, 5}, {6, 7, 8}};
  const UniformGrid layers = build({{TriangleMesh{std::span(box), std::span(three)}}}, {.density = 3, .cap = 64});
  ASSERT_EQ(layers.resolution(kZ), 2U);
  const auto count = std::count(layers.slots.begin(), layers.slots.end(), LeafSlot{LeafSlot::kRepeated, 0});
  EXPECT_GE(count, 3);
  EXPECT_LE(count, 3 + 1);
}

TEST(CellCut, APartThatOnlyTouchesThePlaneIsLeftToTheOtherSide) {
  const Box3f box{{0, 0, 0}, {2, 1, 1}}, below{{0, 0, 0}, {1, 1, 1}}, above{{1, 0, 0}, {2, 1, 1}},
      flat{{1, 0, 0}, {1, 1, 1}};
  const auto sides = [&](const Box3f& low, const Box3f& high) {
    const CutBoxes cut = settled({low, high}, box, kX, 1);
    return std::pair(!cut.below.is_empty(), !cut.above.is_empty());
  };
  EXPECT_EQ(sides(below, above), std::pair(true, true));
  EXPECT_EQ(sides(flat, above), std::pair(false, true));
  EXPECT_EQ(sides(below, flat), std::pair(true, false));
  EXPECT_EQ(sides(flat, flat), std::pair(false, true));
  EXPECT_EQ(sides(flat, {}), std::pair(true, false));
  EXPECT_EQ(sides({}, flat), std::pair(false, true));
  EXPECT_EQ(sides({}, {}), std::pair(true, true));
}

TEST(UniformGrid, TheCapMakesItCoarser) {
  const RandomTriangles triangles(3000, 5, 1);
  const std::vector<Geometry> geometries{triangles.geometry()};
  size_t last = 0;
  for (const double cap : {1.0, 3.0, 10.0, 1000.0}) {
    const UniformGrid grid = build(geometries, {.density = 16, .cap = cap});
    EXPECT_LE(static_cast<double>(grid.slots.size()), cap * 3000);
    EXPECT_GT(grid.cell_count(), last);
    EXPECT_EQ(find_fault(grid, geometries), std::nullopt);
    last = grid.cell_count();
  }
}

TEST(UniformGrid, GivesUpAtItsMemoryLimit) {
  const RandomTriangles triangles(3000);
  WorkLimit limit;
  limit.bytes = 1000;
  error_of(ErrorCode::stopped, [&] { build({triangles.geometry()}, {}, limit); });
}

TEST(UniformGrid, FaultsAreFound) {
  const RandomTriangles triangles(200);
  const std::vector<Geometry> geometries{triangles.geometry()};
  const UniformGrid good = build(geometries, {});
  ASSERT_EQ(find_fault(good, geometries), std::nullopt);
  EXPECT_EQ(find_fault(UniformGrid{}, {}), std::nullopt);
  const std::pair<const char*, std::function<void(UniformGrid&)>> faults[] = {
      {"no primitive", [](UniformGrid& g) { g.slots[3].primitive = 200; }},
      {"repeat mark", [](UniformGrid& g) { g.slots[3].geometry_bits ^= LeafSlot::kRepeated; }},
      {"decrease", [](UniformGrid& g) { std::swap(g.planes[1][1], g.planes[1][2]); }},
      {"out of the grid", [](UniformGrid& g) { g.planes[2].back() = g.planes[2][g.planes[2].size() - 2]; }},
      {"different numbers", [](UniformGrid& g) { g.planes[0].pop_back(); }},
      {"decrease", [](UniformGrid& g) { g.offsets[1] = g.offsets.back(); }},
      {"miss slots", [](UniformGrid& g) { g.slots.push_back(g.slots.back()); }},
      {"", [](UniformGrid& g) {  // a cell's first slot goes to the cell before it
         const auto full = std::adjacent_find(g.offsets.begin(), g.offsets.end(), std::less<>());
         ++*(full + 1 - (full == g.offsets.begin() ? 0 : 1));
       }}};
  for (const auto& [what, damage] : faults) {
    UniformGrid bad = good;
    damage(bad);
    const auto fault = find_fault(bad, geometries);
    ASSERT_TRUE(fault.has_value()) << what;
    EXPECT_NE(fault->find(what), std::string::npos) << *fault;
  }
}

/// A sphere of many small triangles in the middle of a field of large ones.
RandomTriangles teapot_in_a_stadium(float teapot) {
  RandomTriangles scene(0);
  const auto add = [&](Vec3f a, Vec3f b, Vec3f c) {
    const auto first = static_cast<uint32_t>(scene.vertices.size());
    scene.vertices.insert(scene.vertices.end(), {a, b, c});
    scene.triangles.push_back({first, first + 1, first + 2});
  };
  Random random(4);
  for (int i = 0; i < 5000; ++i) {
    const Vec3f p = teapot * random.vector();
    add(p, p + 0.05F * teapot * random.vector(), p + 0.05F * teapot * random.vector());
  }
  for (int i = 0; i < 5000; ++i) {
    const Vec3f p = 100.0F * random.vector();
    add(p, p + random.vector(), p + random.vector());
  }
  return scene;
}

TEST(UniformGrid, ATeapotInAStadiumIsItsLimit) {
  const auto tests_per_ray = [](const RandomTriangles& triangles, float teapot, const char* structure) {
    Scene scene;
    scene.add(triangles.geometry());
    scene.build({.structure = structure});
    Random random(6);
    TraceCounts counts;
    for (int i = 0; i < 1000; ++i) {
      const Vec3f from = 90.0F * random.vector(), to = teapot * random.vector();
      scene.closest_hit({.origin = from, .direction = to - from}, counts);
    }
    return static_cast<double>(counts.primitives) / 1000;
  };
  const RandomTriangles even = teapot_in_a_stadium(50), stadium = teapot_in_a_stadium(0.5F);
  const double grid_even = tests_per_ray(even, 50, "uniform_grid"), bvh_even = tests_per_ray(even, 50, "binned_sah");
  const double grid = tests_per_ray(stadium, 0.5F, "uniform_grid"), bvh = tests_per_ray(stadium, 0.5F, "binned_sah");
  RecordProperty("grid", std::to_string(grid));
  RecordProperty("binned_sah", std::to_string(bvh));
  EXPECT_GT(grid, 100 * bvh) << grid << " against " << bvh;
  EXPECT_GT(grid / bvh, 10 * grid_even / bvh_even) << grid_even << " against " << bvh_even;
}

}  // namespace
}  // namespace kerf::test
