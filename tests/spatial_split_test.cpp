// What spatial_split has of its own: its cap and how it is divided, cuts, unsplitting, one slot for each primitive in a
// leaf. What holds for every builder is in build_test and structures_test, which go through the menu.

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <string>

#include "kerf/base/parallel.h"
#include "kerf/build/builders.h"
#include "kerf/build/spatial_order.h"
#include "kerf/references/early_split.h"
#include "tests/support/random_scene.h"

namespace kerf {
namespace {

using test::RandomTriangles;

OptionValues options_of(const std::map<std::string, double>& given = {}) {
  for (const BuilderEntry& builder : builders()) {
    if (builder.name != "spatial_split") continue;
    OptionValues values(builder.options);
    for (const auto& [name, value] : given) values.set(builder.name, name, value);
    return values;
  }
  ADD_FAILURE();
  return {};
}

OptionValues binned_options() { return OptionValues(builders()[0].options); }

/// A mesh with what a builder needs of it.
struct Input {
  RandomTriangles triangles;
  Geometry geometry;
  std::span<const Geometry> geometries{&geometry, 1};
  std::vector<Reference> references;

  Input(uint32_t count, float long_share) : triangles(count, 1, long_share), geometry(triangles.geometry()) {
    references = make_references(geometries).references;
  }
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;
  Clipper clipper() const { return geometry_clipper(geometries); }
  Bvh build(const std::map<std::string, double>& given = {}) const {
    Bvh bvh = build_spatial_split({references, clipper()}, options_of(given));
    mark_repeated(bvh, geometries);
    EXPECT_EQ(find_fault(bvh, geometries, 4), std::nullopt);
    return bvh;
  }
};

/// Cuts boxes that their primitives fill.
constexpr Clipper kSolid = {[](const void*, const Reference& reference, uint32_t axis, float position) {
  ClippedBoxes boxes{reference.bounds(), reference.bounds()};
  boxes.below.upper[axis] = std::min(boxes.below.upper[axis], position);
  boxes.above.lower[axis] = std::max(boxes.above.lower[axis], position);
  return boxes;
}};

Reference box(uint32_t primitive, Vec3f lower, Vec3f upper) { return {lower, 0, upper, primitive}; }

TEST(SpatialSplit, WithoutAClipperItIsBinnedSah) {
  const Input input(3000, 0.5F);
  EXPECT_EQ(tree_hash(build_spatial_split(input.references, options_of())),
            tree_hash(build_binned_sah(input.references, binned_options())));
}

TEST(SpatialSplit, NothingToSpareIsBinnedSahToo) {
  const Input input(3000, 0.5F);
  const Bvh binned = build_binned_sah(input.references, binned_options());
  for (const std::map<std::string, double>& given : {std::map<std::string, double>{{"cap", 1}}, {{"overlap", 1}}}) {
    const Bvh bvh = input.build(given);
    EXPECT_EQ(bvh.slots.size(), input.references.size());
    EXPECT_EQ(sah_cost(bvh), sah_cost(binned));
  }
}

TEST(SpatialSplit, TheCapIsHonouredAndUsed) {
  const Input input(3000, 0.5F);
  EXPECT_LE(input.build({{"cap", 1.001}}).slots.size(), 3003U);
  double last_cost = sah_cost(input.build({{"cap", 1}}));
  for (const double cap : {1.05, 1.2, 1.5, 2.0, 4.0}) {
    const Bvh bvh = input.build({{"cap", cap}});
    EXPECT_LE(static_cast<double>(bvh.slots.size()), cap * 3000);
    EXPECT_GT(bvh.slots.size(), 3000U) << cap;
    EXPECT_LT(sah_cost(bvh), last_cost) << cap;
    last_cost = sah_cost(bvh);
  }
}

TEST(SpatialSplit, TakesAsManySlicesAsItHasRoomFor) {
  const Input input(3000, 0.5F);
  for (const double slices : {2.0, 3.0, double{SpatialSlices::kMost}}) {
    EXPECT_GT(input.build({{"spatial_bins", slices}}).slots.size(), 3000U) << slices;
  }
  EXPECT_THROW(options_of({{"spatial_bins", SpatialSlices::kMost + 1}}), Error);
}

TEST(SpatialSplit, NeedlesGain) {
  // Diagonal needles among small triangles; and needles only, where no single cut is cheaper than none, but many are.
  const std::map<float, double> bars{{0.5F, 0.65}, {1.0F, 0.8}};
  for (const auto& [long_share, bar] : bars) {
    const Input input(3000, long_share);
    const double binned = sah_cost(build_binned_sah(input.references, binned_options()));
    EXPECT_LT(sah_cost(input.build()), bar * binned) << long_share;
  }
}

TEST(SpatialSplit, TheCapGoesWhereLargeReferencesAre) {
  // Needles beside many pebbles: by counts alone they would get 13 % of the pieces to spare.
  Input input(1500, 0.5F);
  const RandomTriangles pebbles(10000, 2, 0);
  for (const TriangleCorners& corners : pebbles.triangles) {
    const auto first = static_cast<uint32_t>(input.triangles.vertices.size());
    for (const uint32_t corner : corners) {
      input.triangles.vertices.push_back(0.1F * pebbles.vertices[corner] + Vec3f{40, 0, 0});
    }
    input.triangles.triangles.push_back({first, first + 1, first + 2});
  }
  input.geometry = input.triangles.geometry();
  input.references = make_references(input.geometries).references;
  const double plain = sah_cost(input.build({{"cap", 1}})), little = sah_cost(input.build({{"cap", 1.2}})),
               much = sah_cost(input.build({{"cap", 64}}));
  EXPECT_LT(much, 0.8 * plain);
  EXPECT_LT(little, plain - 0.7 * (plain - much));
}

TEST(SpatialSplit, PiecesOfAPrimitiveInOneLeafAreOneSlot) {
  const std::vector<Reference> references{box(7, {0, 0, 0}, {1, 1, 1}), box(3, {0, 0, 0}, {2, 1, 1}),
                                          box(7, {1, 0, 0}, {2, 1, 1})};
  const Bvh bvh = build_spatial_split({references, kSolid}, options_of({{"inner_cost", 100}}));
  EXPECT_EQ(bvh.slots, (std::vector<LeafSlot>{{0, 3}, {0, 7}}));
  ASSERT_EQ(bvh.nodes.size(), 1U);
  EXPECT_EQ(bvh.nodes[0], (BvhNode{{0, 0, 0}, 0, {2, 1, 1}, 2}));
}

TEST(SpatialSplit, NoLeafHoldsAPrimitiveTwice) {
  Input input(2000, 0.5F);
  input.references = early_split(input.references, input.clipper(), EarlySplit::with_budget(3)).references;
  for (const double cap : {1.0, 2.0}) {
    const Bvh bvh = input.build({{"cap", cap}});
    for (const BvhNode& node : bvh.nodes) {
      std::set<uint32_t> primitives;
      for (uint32_t s = node.first; s < node.first + node.count; ++s) primitives.insert(bvh.slots[s].primitive);
      EXPECT_EQ(primitives.size(), node.count);
    }
    EXPECT_LE(static_cast<double>(bvh.slots.size()), cap * static_cast<double>(input.references.size()));
  }
}

TEST(SpatialSplit, SameTreeForAnyNumberOfThreads) {
  const Input input(20000, 0.3F);
  const auto hash_with = [&](int threads) {
    uint64_t hash = 0;
    with_threads(threads, [&] { hash = tree_hash(input.build({{"cap", 1.3}})); });
    return hash;
  };
  const uint64_t one = hash_with(1);
  EXPECT_EQ(hash_with(2), one);
  EXPECT_EQ(hash_with(7), one);
}

TEST(SpatialSplit, NodesFitWhatCutsLeave) {
  // References with boxes too large: a cut finds out how little is in them.
  Input input(1000, 1);
  for (Reference& reference : input.references) {
    reference.lower = reference.lower - Vec3f{0.5F, 0.5F, 0.5F};
    reference.upper = reference.upper + Vec3f{0.5F, 0.5F, 0.5F};
  }
  EXPECT_GT(input.build().slots.size(), 1000U);  // which looks for faults
}

TEST(SpatialSplit, DepthBoundHoldsWithPiecesToo) {
  const Input input(120, 1);
  for (const uint32_t depth : {5U, 6U, 7U, 8U}) {
    Bvh bvh = build_spatial_split({input.references, input.clipper()}, options_of({{"depth", depth}, {"cap", 64}}));
    mark_repeated(bvh, input.geometries);
    EXPECT_EQ(find_fault(bvh, input.geometries, 4, depth), std::nullopt) << depth;
  }
}

TEST(SpatialSplit, APlankAcrossTwoPilesIsCut) {
  // Four boxes at either end of a plank; without a cut, one end's box would reach to the other.
  std::vector<Reference> references{box(0, {0, 0, 0}, {16, 1, 1})};
  for (uint32_t i = 0; i < 4; ++i) {
    const auto y = 1 + static_cast<float>(i);
    references.push_back(box(1 + i, {0, y, 0}, {1, y + 1, 1}));
    references.push_back(box(5 + i, {15, y, 0}, {16, y + 1, 1}));
  }
  const Bvh bvh = build_spatial_split({references, kSolid}, options_of({{"leaf", 8}, {"inner_cost", 0.01}}));
  EXPECT_GE(bvh.slots.size(), 10U);
  const Box3f left = bvh.nodes[1].bounds(), right = bvh.nodes[2].bounds();
  EXPECT_EQ(half_area(intersected(left, right)) > 0 && left.upper.x != right.lower.x && right.upper.x != left.lower.x,
            false);
  EXPECT_LT(sah_cost(bvh), sah_cost(build_binned_sah(references, binned_options())));
}

TEST(SpatialBins, CostsOfPlanesWorkedByHand) {
  // Twice the same rod of 8 x 1 x 1: at x = p both sides have two pieces, 2 (2 p + 1) + 2 (2 (8 - p) + 1) = 36.
  const std::vector<Reference> rods{box(0, {0, 0, 0}, {8, 1, 1}), box(1, {0, 0, 0}, {8, 1, 1})};
  const SpatialSlices slices({{0, 0, 0}, {8, 1, 1}}, 4);
  const SpatialPlane plane = cheapest_spatial_plane(rods, {}, slices, kSolid, {4, 4, 100});
  ASSERT_TRUE(plane.is_found());
  EXPECT_EQ(plane.cost, 36);
  EXPECT_EQ(plane.axis, 0U);
  EXPECT_EQ(plane.position, 2);
  EXPECT_EQ(plane.below_count, 2U);
  EXPECT_EQ(plane.above_count, 2U);
  EXPECT_EQ(plane.below, (Box3f{{0, 0, 0}, {2, 1, 1}}));
  EXPECT_EQ(plane.above, (Box3f{{2, 0, 0}, {8, 1, 1}}));
  EXPECT_FALSE(cheapest_spatial_plane(rods, {}, slices, kSolid, {3, 4, 100}).is_found());
  EXPECT_FALSE(cheapest_spatial_plane(rods, {}, slices, kSolid, {4, 1, 100}).is_found());
  EXPECT_FALSE(cheapest_spatial_plane(rods, {}, slices, kSolid, {4, 4, 36}).is_found());
  // A cube at the far end draws the plane there: 2 (2 * 6 + 1) + 3 (2 * 2 + 1) = 41 at 6, and at 2 it is 49.
  std::vector<Reference> more = rods;
  more.push_back(box(2, {7, 0, 0}, {8, 1, 1}));
  const SpatialPlane far = cheapest_spatial_plane(more, {}, slices, kSolid, {5, 5, 100});
  EXPECT_EQ(far.cost, 41);
  EXPECT_EQ(far.position, 6);
  EXPECT_EQ(far.below_count, 2U);
  EXPECT_EQ(far.above_count, 3U);
}

TEST(SpatialBins, ManyReferencesAreBinnedAsFewAre) {
  const Input input(20000, 0.5F);
  Box3f bounds;
  for (const Reference& reference : input.references) bounds.extend(reference.bounds());
  const SpatialSlices slices(bounds, 16);
  const SpatialLimits limits{1e12, 1e12, 1e30};
  const SpatialPlane plane = cheapest_spatial_plane(input.references, {}, slices, input.clipper(), limits);
  ASSERT_TRUE(plane.is_found());
  uint32_t below = 0, above = 0;
  for (const Reference& r : input.references) {
    below += r.lower[plane.axis] < plane.position ? 1 : 0;
    above += r.upper[plane.axis] > plane.position ? 1 : 0;
  }
  EXPECT_EQ(plane.below_count, below);
  EXPECT_EQ(plane.above_count, above);
  EXPECT_TRUE(bounds.contains(plane.below));
  EXPECT_LE(plane.below.upper[plane.axis], plane.position);
  EXPECT_GE(plane.above.lower[plane.axis], plane.position);
}

TEST(SpatialBins, SpansAgreeWithPlanesForEverySize) {
  std::mt19937 random(1);
  size_t usable = 0;
  for (const float scale : {1e-44F, 1e-40F, 1e-20F, 1.0F, 1e20F, 1e36F}) {
    for (const float offset : {0.0F, 1.0F, 1e6F}) {
      const Box3f bounds{Vec3f{offset, -1, 1} * scale, Vec3f{offset + 1, 1, 1} * scale};
      const SpatialSlices slices(bounds, 16);
      EXPECT_FALSE(slices.is_usable(2));
      for (uint32_t axis = 0; axis < 2; ++axis) {
        if (!slices.is_usable(axis)) continue;
        ++usable;
        const auto place = [&] {
          if (random() % 4 == 0) return slices.plane(axis, random() % 17);
          const float share = static_cast<float>(random() >> 8) * 0x1p-24F;
          return std::clamp(bounds.lower[axis] + share * (bounds.upper[axis] - bounds.lower[axis]), bounds.lower[axis],
                            bounds.upper[axis]);
        };
        for (int k = 0; k < 1000; ++k) {
          Reference r = box(0, bounds.lower, bounds.upper);
          r.lower[axis] = place();
          r.upper[axis] = random() % 8 == 0 ? r.lower[axis] : place();
          if (r.upper[axis] < r.lower[axis]) std::swap(r.lower[axis], r.upper[axis]);
          const SpatialSlices::Span span = slices.span(r, axis);
          ASSERT_LE(span.first, span.last);
          ASSERT_LT(span.last, 16U);
          for (uint32_t i = 1; i < 16; ++i) {
            const bool is_below = r.upper[axis] <= slices.plane(axis, i);
            ASSERT_EQ(span.last < i, is_below);
            ASSERT_EQ(span.first >= i, !is_below && r.lower[axis] >= slices.plane(axis, i));
          }
        }
      }
    }
  }
  EXPECT_GE(usable, 20U);
}

TEST(SpatialOrder, UnsplittingKeepsWholeWhatIsCheaperWhole) {
  // Ten cubes on either side of x = 2. One reference hardly passes the plane; one reaches from end to end.
  std::vector<Reference> references;
  for (uint32_t i = 0; i < 10; ++i) {
    references.push_back(box(i, {0, 0, 0}, {1, 1, 1}));
    references.push_back(box(10 + i, {3, 0, 0}, {4, 1, 1}));
  }
  references.push_back(box(20, {0.5F, 0, 0}, {2.1F, 1, 1}));
  references.push_back(box(21, {0, 0, 0}, {4, 1, 1}));
  SpatialOrder order(references, 30);
  EXPECT_EQ(order.whole().count(), 22U);
  EXPECT_EQ(order.whole().room(), 30U);
  // The two across count on both sides: 12 below with half area 5, 12 above with half area 5.
  const SpatialPlane plane{120, 0, 2, 12, 12, {{0, 0, 0}, {2, 1, 1}}, {{2, 0, 0}, {4, 1, 1}}};
  Halves halves = order.cut(order.whole(), plane, kSolid);
  EXPECT_EQ(halves.left.count(), 12U);
  EXPECT_EQ(halves.right.count(), 11U);
  EXPECT_EQ(halves.left.bounds, (Box3f{{0, 0, 0}, {2.1F, 1, 1}}));
  EXPECT_EQ(halves.right.bounds, (Box3f{{2, 0, 0}, {4, 1, 1}}));
  const auto boxes_of = [&](const Subset& subset, uint32_t primitive) {
    std::vector<Box3f> boxes;
    for (uint32_t i = subset.begin; i < subset.end; ++i) {
      if (order.reference(i).primitive == primitive) boxes.push_back(order.reference(i).bounds());
    }
    return boxes;
  };
  const auto check = [&] {
    EXPECT_EQ(boxes_of(halves.left, 20), (std::vector<Box3f>{{{0.5F, 0, 0}, {2.1F, 1, 1}}}));
    EXPECT_TRUE(boxes_of(halves.right, 20).empty());
    EXPECT_EQ(boxes_of(halves.left, 21), (std::vector<Box3f>{{{0, 0, 0}, {2, 1, 1}}}));
    EXPECT_EQ(boxes_of(halves.right, 21), (std::vector<Box3f>{{{2, 0, 0}, {4, 1, 1}}}));
    for (uint32_t i = 0; i < 10; ++i) {
      EXPECT_EQ(boxes_of(halves.left, i).size(), 1U);
      EXPECT_EQ(boxes_of(halves.right, 10 + i).size(), 1U);
    }
  };
  check();
  order.make_room(order.whole(), halves);
  EXPECT_EQ(halves.left.room() + halves.right.room(), 30U);
  EXPECT_EQ(halves.right.begin, halves.left.begin + halves.left.room());
  EXPECT_GT(halves.left.spare, 0U);
  EXPECT_GT(halves.right.spare, 0U);
  check();
}

TEST(SpatialOrder, ACutThatLeavesASideEmptyHalvesInstead) {
  // A clipper that finds nothing above the plane, as rounding may.
  const Clipper nothing_above = {[](const void*, const Reference& reference, uint32_t axis, float position) {
    ClippedBoxes boxes{reference.bounds(), {}};
    boxes.below.upper[axis] = position;
    return boxes;
  }};
  SpatialOrder order({box(0, {0, 0, 0}, {4, 1, 1}), box(1, {0, 0, 0}, {4, 1, 1}), box(2, {0, 0, 0}, {4, 1, 1})}, 6);
  const SpatialPlane plane{15, 0, 2, 3, 3, {{0, 0, 0}, {2, 1, 1}}, {{2, 0, 0}, {4, 1, 1}}};
  const Halves halves = order.cut(order.whole(), plane, nothing_above);
  EXPECT_EQ(halves.left.count(), 1U);
  EXPECT_EQ(halves.right.count(), 2U);
  EXPECT_EQ(halves.right.begin, halves.left.end);
}

}  // namespace
}  // namespace kerf
