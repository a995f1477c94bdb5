// The guide of automatic splitting and what it judges planes by.

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <limits>

#include "kerf/build/spatial_bins.h"
#include "kerf/references/clipper.h"
#include "kerf/choose/split_guide.h"
#include "kerf/references/middle_cut.h"
#include "tests/support/soup.h"

namespace kerf::test {
namespace {

TEST(SplitGuide, LeavesWallsInFlatBoxesAlone) {
  Soup soup;
  soup.add({0, 0, 0}, {8, 0, 0}, {0, 8, 0});     // fills half of a flat box
  soup.add({0, 0, 0}, {8, 0, 1}, {0, 8, 8});     // leans
  soup.add({0, 0, 0}, {8, 8, 0}, {8, 7.9F, 0});  // flat, too, but thin
  const Geometry geometry{soup.mesh()};
  const std::span<const Geometry> geometries(&geometry, 1);
  Judges judges;
  for (const Reference& reference : make_references(geometries).references) judges.add(reference, 1);
  GuideRules rules;
  rules.scene_unit = 1;
  rules.scene_gain = 4;
  const SplitGuide guide(judges, geometries, rules, {});
  GainCurve curve;
  std::array<size_t, 3> pieces{};
  for (const Reference& reference : judges.references) {
    guide.split(reference, geometry_clipper(geometries), curve, [&](const Reference& piece) {
      ++pieces[piece.primitive];
      return true;
    });
  }
  EXPECT_EQ(pieces[0], 1U);
  EXPECT_GT(pieces[1], 2U);
  EXPECT_GT(pieces[2], 2U);
}

TEST(SplitGuide, MayCutWithinAnotherCut) {
  // As where a callback builds something else, while pieces are handed out.
  Soup soup;
  soup.add({0, 0, 0}, {8, 0, 1}, {0, 8, 8});
  const Geometry geometry{soup.mesh()};
  const std::span<const Geometry> geometries(&geometry, 1);
  const Clipper clipper = geometry_clipper(geometries);
  const Reference reference = make_references(geometries).references[0];
  Judges judges;
  judges.add(reference, 1);
  GuideRules rules;
  rules.scene_unit = 1;
  const SplitGuide guide(judges, geometries, rules, {});
  const auto pieces = [&](const std::function<void()>& in_between) {
    GainCurve curve;
    size_t count = 0;
    guide.split(reference, clipper, curve, [&](const Reference&) {
      in_between();
      return ++count > 0;
    });
    return count;
  };
  const size_t alone = pieces([] {});
  EXPECT_GT(alone, 2U);
  EXPECT_EQ(pieces([&] { pieces([] {}); }), alone);
}

TEST(GainCurve, TakesAnyGain) {
  GainCurve curve;
  curve.add(std::numeric_limits<double>::infinity(), 1, 2);
  curve.add(0, 1, 3);
  EXPECT_EQ(curve.buckets.back().references, 2U);
  EXPECT_EQ(curve.buckets.front().references, 3U);
}

TEST(RoughClipper, BoundsTheTwoPartsOfATriangleWithinItsBox) {
  Soup soup;
  soup.add({0, 0, 0}, {4, 4, 0}, {4, 0, 4});
  const Geometry geometry{soup.mesh()};
  const std::span<const Geometry> geometries(&geometry, 1);
  Reference reference = make_references(geometries).references[0];
  const Clipper clipper = rough_clipper(geometries);
  ClippedBoxes parts = clipper(reference, 0, 1);
  EXPECT_EQ(parts.below, (Box3f{{0, 0, 0}, {1, 1, 1}}));
  EXPECT_EQ(parts.above, (Box3f{{1, 0, 0}, {4, 4, 4}}));
  reference = with_box(reference, {{0, 0, 0}, {3, 3, 1}});
  parts = clipper(reference, 0, 2);
  EXPECT_EQ(parts.below, (Box3f{{0, 0, 0}, {2, 2, 1}}));
  EXPECT_EQ(parts.above, (Box3f{{2, 0, 0}, {3, 3, 1}}));
  EXPECT_TRUE(clipper(reference, 0, -1).below.is_empty());
  // A product of such distances is below all floats.
  constexpr float kTiny = 0x1p-90F;
  for (Vec3f& v : soup.vertices) v = kTiny * v;
  parts = clipper(make_references(geometries).references[0], 0, kTiny);
  EXPECT_EQ(parts.below, (Box3f{{0, 0, 0}, {kTiny, kTiny, kTiny}}));
}

TEST(SpatialPlane, WeightsCountAsSoManyReferences) {
  // A rod and three times the same pebble at its end, once by its weight and once in full.
  Soup soup;
  soup.add({0, 0, 0}, {8, 1, 1}, {8, 0, 1});
  for (int i = 0; i < 3; ++i) soup.add({7, 0, 0}, {8, 1, 1}, {7.5F, 0, 1});
  const Geometry geometry{soup.mesh()};
  const std::span<const Geometry> geometries(&geometry, 1);
  const std::vector<Reference> all = make_references(geometries).references;
  const Clipper clipper = geometry_clipper(geometries);
  const SpatialSlices slices({{0, 0, 0}, {8, 1, 1}}, 8);
  const SpatialLimits any{100, 100, 1e30};
  const SpatialPlane full = cheapest_spatial_plane(all, {}, slices, clipper, any);
  const std::array<float, 2> weights{1, 3};
  const SpatialPlane weighted = cheapest_spatial_plane(std::span(all).first(2), weights, slices, clipper, any);
  ASSERT_TRUE(full.is_found());
  EXPECT_EQ(weighted.cost, full.cost);
  EXPECT_EQ(weighted.position, full.position);
  EXPECT_EQ(weighted.above_count, 4);
}

}  // namespace
}  // namespace kerf::test
