// The bounding interval hierarchy: traversal on a tree worked by hand, the planes of the build, empty space cut off,
// the check of invariants.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "kerf/build/bih.h"
#include "kerf/references/early_split.h"
#include "kerf/trace/trace_bih.h"
#include "kerf/tree/cell_slots.h"
#include "tests/support/error_of.h"
#include "tests/support/four_plates.h"
#include "tests/support/random_scene.h"

namespace kerf::test {
namespace {

/// The plates in leaves of their own, the upper two behind a node that cuts off space that is empty:
///
///              0 [0.5, 3.5]
///     1 [0.5, 1.5]        2 [2.5, 3.5]
///     3 [0.5]  4 [1.5]    5: y in [0, 1]
///                         6 [2.5]  7 [3.5]
Bih eight_nodes() {
  Bih bih;
  bih.bounds = {{0.5F, -1, 0}, {3.5F, 1, 1}};
  bih.nodes = {BihNode::pair(1, kX, 1.5F, 2.5F),
               BihNode::pair(3, kX, 0.5F, 1.5F),
               BihNode::single(5, kY, 0, 1),
               BihNode::leaf(0, 1),
               BihNode::leaf(1, 1),
               BihNode::pair(6, kX, 2.5F, 3.5F),
               BihNode::leaf(2, 1),
               BihNode::leaf(3, 1)};
  for (uint32_t i = 0; i < 4; ++i) bih.slots.push_back({0, i});
  return bih;
}

class EightNodes : public testing::Test {
 protected:
  EightNodes() : tracer_{eight_nodes(), plates_.geometries()} {
    EXPECT_EQ(find_fault(tracer_.bih, plates_.geometries()), std::nullopt);
  }
  Outcome trace(const Ray& ray) const { return closest(bih_table(), &tracer_, ray); }

  FourPlates plates_;
  BihTracer tracer_;
};

TEST_F(EightNodes, NearChildFirstAndChildrenBehindTheHitAreSkipped) {
  const auto [hit, counts] = trace({.origin = {0, 0.25F, 0.25F}, .direction = {1, 0, 0}});
  EXPECT_EQ(hit.primitive, 0U);
  EXPECT_EQ(hit.t, 0.5F);
  expect_counts(counts, 3, 1, 5);  // nodes 0, 1, 3
  const auto back = trace({.origin = {10, 0.25F, 0.25F}, .direction = {-2, 0, 0}});
  EXPECT_EQ(back.hit.primitive, 3U);
  expect_counts(back.counts, 4, 1, 6);  // nodes 0, 2, 5, 7
}

TEST_F(EightNodes, ARayThroughAllIntervalsAndNoTriangleVisitsAll) {
  const auto [hit, counts] = trace({.origin = {0, 0.75F, 0.75F}, .direction = {1, 0, 0}});
  EXPECT_FALSE(hit);
  expect_counts(counts, 8, 4, 1 + 3 * 2 + 1);
  expect_counts(trace({.origin = {0, 2, 0.25F}, .direction = {1, 0, 0}}).counts, 0, 0, 1);
}

TEST_F(EightNodes, ASingleChildIsSkippedInEmptySpace) {
  const auto [hit, counts] = trace({.origin = {0, -0.5F, 0.25F}, .direction = {1, 0, 0}});
  EXPECT_FALSE(hit);
  expect_counts(counts, 5, 2, 6);  // nodes 0, 1, 3, 4 and 2, but not 5
}

TEST_F(EightNodes, BetweenTheIntervalsNeitherChildIsVisited) {
  const auto [hit, counts] = trace({.origin = {2, 3, 0.25F}, .direction = {0, -1, 0}});
  EXPECT_FALSE(hit);
  expect_counts(counts, 1, 0, 3);
  // In the plane of a plate, in the direction of its negative zero.
  expect_counts(trace({.origin = {2.5F, 3, 0.25F}, .direction = {-0.0F, -1, 0}}).counts, 4, 1, 6);
}

TEST_F(EightNodes, TheIntervalCullsAtBothEnds) {
  const Vec3f origin{0, 0.25F, 0.25F}, x{1, 0, 0};
  const auto second = trace({.origin = origin, .t_min = 1, .direction = x});
  EXPECT_EQ(second.hit.primitive, 1U);
  expect_counts(second.counts, 3, 1, 5);  // nodes 0, 1, 4
  expect_counts(trace({.origin = origin, .t_min = 1.75F, .direction = x, .t_max = 2.25F}).counts, 1, 0, 3);
}

Bih build(const std::vector<Geometry>& geometries, double cut_off, uint32_t leaf = 1, const WorkLimit& limit = {}) {
  return build_bih(make_references(geometries).references, {.leaf_size = leaf, .inner_cost = leaf > 1 ? 1e9 : 0},
                   cut_off, limit);
}

TEST(Bih, PlanesAreThoseOfAGridOverTheScene) {
  // The box is [0.5, 3.5] x [-1, 1] x [0, 1] with the floor's [0, 4]: halves at x = 2, then at 1 and 3.
  const FourPlates plates(true);
  const Bih bih = build({plates.geometry}, 0);
  ASSERT_EQ(find_fault(bih, plates.geometries()), std::nullopt);
  EXPECT_EQ(bih.bounds, (Box3f{{0, -1, 0}, {4, 1, 1}}));
  EXPECT_EQ(bih.nodes.size(), 9U);
  // The floor's centre is 2, and on a plane means below it.
  EXPECT_EQ(bih.nodes[0], BihNode::pair(1, kX, 4, 2.5F));
}

TEST(Bih, EmptySpaceIsCutOffWhereItPays) {
  // Two flat heaps far apart along y, spread along x: without single children their nodes keep the whole of y.
  std::vector<Vec3f> vertices;
  std::vector<TriangleCorners> corners;
  for (uint32_t i = 0; i < 64; ++i) {
    const float x = static_cast<float>(i), y = i < 32 ? 0.0F : 10.0F;
    vertices.insert(vertices.end(), {{x, y, 0}, {x + 1, y + 1, 0}, {x, y, 1}});
    corners.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const std::vector<Geometry> geometries{{TriangleMesh{vertices, corners}}};
  const auto singles = [&](double cut_off) {
    const Bih bih = build(geometries, cut_off);
    EXPECT_EQ(find_fault(bih, geometries), std::nullopt);
    size_t count = 0;
    for (const BihNode& node : bih.nodes) count += node.is_single() ? 1 : 0;
    return count;
  };
  EXPECT_EQ(singles(0), 0U);
  EXPECT_GE(singles(0.8), 2U);
  EXPECT_GE(singles(1), singles(0.8));
  const BihTracer plain{build(geometries, 0), geometries}, cut{build(geometries, 0.8), geometries};
  const Ray between{.origin = {-1, 5, 0.5F}, .direction = {1, 0, 0}};
  EXPECT_GT(closest(bih_table(), &plain, between).counts.nodes, 100U);
  EXPECT_LT(closest(bih_table(), &cut, between).counts.nodes, 6U);
}

TEST(Bih, DepthIsBoundedWithAllThatIsCutOff) {
  // Ever smaller, ever nearer to the corner: a new plane for each.
  std::vector<Vec3f> vertices;
  std::vector<TriangleCorners> corners;
  for (uint32_t i = 0; i < 50; ++i) {
    const float x = std::ldexp(1.0F, -static_cast<int>(i));
    vertices.insert(vertices.end(), {{x, x, x}, {1.01F * x, x, x}, {x, 1.01F * x, x}});
    corners.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const std::vector<Geometry> geometries{{TriangleMesh{vertices, corners}}};
  const Bih bih = build(geometries, 1);
  EXPECT_EQ(find_fault(bih, geometries), std::nullopt);  // which checks the depth
  EXPECT_GT(bih.nodes.size(), 99U);
}

TEST(Bih, PiecesAreTaken) {
  const RandomTriangles triangles(500);
  const std::vector<Geometry> geometries{triangles.geometry()};
  const std::span<const Geometry> all = geometries;
  const std::vector<Reference> whole = make_references(all).references;
  std::vector<Reference> pieces = early_split(whole, geometry_clipper(all), {.sa_max = 1, .cap = 8}).references;
  ASSERT_GT(pieces.size(), 600U);
  Bih bih = build_bih(std::move(pieces), {}, 0.8);
  mark_repeated(bih.slots, all);
  EXPECT_EQ(find_fault(bih, all), std::nullopt);
}

TEST(Bih, GivesUpAtItsMemoryLimit) {
  const RandomTriangles triangles(3000);
  WorkLimit limit;
  limit.bytes = 1000;
  error_of(ErrorCode::stopped, [&] { build({triangles.geometry()}, 0.8, 4, limit); });
}

TEST(Bih, FaultsAreFound) {
  const RandomTriangles triangles(200);
  const std::vector<Geometry> geometries{triangles.geometry()};
  const Bih good = build(geometries, 0.8, 3);
  ASSERT_EQ(find_fault(good, geometries), std::nullopt);
  ASSERT_EQ(good.nodes[0].children(), 2U);
  EXPECT_EQ(find_fault(Bih{}, {}), std::nullopt);
  const auto leaf = [](Bih& b) -> BihNode& {
    for (BihNode& node : b.nodes) {
      if (node.is_leaf() && node.count() > 1) return node;
    }
    return b.nodes.back();
  };
  const auto moved = [](const BihNode& n, float left, float right) {
    return BihNode::pair(n.child(), n.axis(), left, right);
  };
  const std::pair<const char*, std::function<void(Bih&)>> faults[] = {
      {"no primitive", [](Bih& b) { b.slots[3].primitive = 200; }},
      {"repeat mark", [](Bih& b) { b.slots[3].geometry_bits ^= LeafSlot::kRepeated; }},
      {"children elsewhere", [](Bih& b) { b.nodes[0].link = b.nodes[0].axis(); }},
      {"children elsewhere", [](Bih& b) { b.nodes[0].link += static_cast<uint32_t>(b.nodes.size()) << 3; }},
      {"plane outside", [&](Bih& b) { b.nodes[0] = moved(b.nodes[0], b.nodes[0].clip(0), 1e9F); }},
      {"plane outside", [&](Bih& b) { b.nodes[0] = moved(b.nodes[0], std::nanf(""), b.nodes[0].clip(1)); }},
      {"", [&](Bih& b) { b.nodes[0] = moved(b.nodes[0], b.nodes[0].clip(0) - 0.01F, b.nodes[0].clip(1)); }},
      {"", [](Bih& b) { b.nodes[0].link ^= 1; }},
      {"is empty", [&](Bih& b) { leaf(b).words[1] = 0; }},
      {"slots out of range", [&](Bih& b) { leaf(b).words[0] = static_cast<uint32_t>(b.slots.size()); }},
      {"slot in no leaf", [&](Bih& b) { --leaf(b).words[1]; }},
      {"slot of another leaf",
       [](Bih& b) {
         ++b.nodes.back().words[1];
         --b.nodes.back().words[0];
       }},
      {"node nothing leads to", [](Bih& b) { b.nodes.push_back(BihNode::leaf(0, 1)); }},
      {"does not hold", [](Bih& b) { std::swap(b.slots.front(), b.slots.back()); }},
  };
  for (const auto& [what, damage] : faults) {
    Bih bad = good;
    damage(bad);
    const auto fault = find_fault(bad, geometries);
    ASSERT_TRUE(fault.has_value()) << what;
    EXPECT_NE(fault->find(what), std::string::npos) << *fault;
  }
}

}  // namespace
}  // namespace kerf::test
