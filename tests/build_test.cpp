// Every builder of the menu: invariants, bounds on depth and leaves, the same tree for any number of threads, quality.

#include <gtest/gtest.h>

#include <map>
#include <stdexcept>
#include <string>

#include "kerf/base/error.h"
#include "kerf/base/parallel.h"
#include "kerf/build/builders.h"
#include "kerf/references/early_split.h"
#include "tests/support/random_scene.h"
#include "tests/support/sizes.h"

namespace kerf {
namespace {

using test::RandomTriangles;

/// A scene's references, split at about R = 2 where asked.
std::vector<Reference> references_of(std::span<const Geometry> geometries, bool split) {
  std::vector<Reference> whole = make_references(geometries).references;
  if (!split) return whole;
  return early_split(whole, geometry_clipper(geometries), EarlySplit::with_budget(2)).references;
}

OptionValues options_of(const BuilderEntry& builder, const std::map<std::string, double>& given = {}) {
  OptionValues values(builder.options);
  for (const auto& [name, value] : given) values.set(builder.name, name, value);
  return values;
}

class EveryBuilder : public testing::TestWithParam<size_t> {
 protected:
  const BuilderEntry& builder() const { return builders()[GetParam()]; }
};

INSTANTIATE_TEST_SUITE_P(Menu, EveryBuilder, testing::Range(size_t{0}, builders().size()),
                         [](const auto& entry) { return std::string(builders()[entry.param].name); });

TEST_P(EveryBuilder, NoReferencesGiveNoTree) {
  const Bvh bvh = builder().build({}, options_of(builder()));
  EXPECT_TRUE(bvh.nodes.empty());
  EXPECT_TRUE(bvh.slots.empty());
  EXPECT_EQ(find_fault(bvh, {}, 4), std::nullopt);
}

TEST_P(EveryBuilder, KeepsAllInvariantsForEveryLeafSizePlainAndSplit) {
  const RandomTriangles scene(3000);
  const Geometry geometry = scene.geometry();
  for (const bool split : {false, true}) {
    for (const uint32_t leaf : {1U, 2U, 4U, 16U}) {
      std::vector<Reference> references = references_of({&geometry, 1}, split);
      const size_t count = references.size();
      Bvh bvh = builder().build(std::move(references), options_of(builder(), {{"leaf", leaf}}));
      mark_repeated(bvh, {&geometry, 1});
      EXPECT_EQ(bvh.slots.size(), count);
      EXPECT_EQ(find_fault(bvh, {&geometry, 1}, leaf), std::nullopt);
      EXPECT_LE(measure(bvh).largest_leaf, leaf);
    }
  }
}

TEST_P(EveryBuilder, LeavesHoldTheirReferencesBoxes) {
  const RandomTriangles scene(500);
  const Geometry geometry = scene.geometry();
  const Bvh bvh = builder().build(references_of({&geometry, 1}, false), options_of(builder()));
  for (const BvhNode& node : bvh.nodes) {
    if (!node.is_leaf()) continue;
    Box3f box;
    for (uint32_t s = node.first; s < node.first + node.count; ++s) {
      box.extend(primitive_bounds(geometry, bvh.slots[s].primitive));
    }
    EXPECT_EQ(box, node.bounds());
  }
}

TEST_P(EveryBuilder, KeepsTheDepthBoundWhereEveryPlaneIsLopsided) {
  // Each triangle is twice as far out as the one before: a spatial median takes off one at a time.
  std::vector<Vec3f> vertices;
  std::vector<TriangleCorners> triangles;
  for (uint32_t i = 0; i < 100; ++i) {
    const float x = std::ldexp(1.0F, static_cast<int>(i));
    vertices.insert(vertices.end(), {{x, 0, 0}, {x * 1.1F, 1, 0}, {x, 0, 1}});
    triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const Geometry geometry{TriangleMesh{std::span<const Vec3f>(vertices), std::span<const TriangleCorners>(triangles)}};
  for (const uint32_t depth : {7U, 8U, 10U, 20U, 64U}) {
    const Bvh bvh =
        builder().build(references_of({&geometry, 1}, false), options_of(builder(), {{"depth", depth}, {"leaf", 1}}));
    EXPECT_EQ(find_fault(bvh, {&geometry, 1}, 1, depth), std::nullopt) << depth;
  }
  EXPECT_THROW(
      builder().build(references_of({&geometry, 1}, false), options_of(builder(), {{"depth", 6}, {"leaf", 1}})), Error);
}

TEST_P(EveryBuilder, SameTreeForAnyNumberOfThreads) {
  const RandomTriangles scene(2 * test::kManyThings);
  const Geometry geometry = scene.geometry();
  const auto hash_with = [&](int threads) {
    uint64_t hash = 0;
    with_threads(threads, [&] {
      hash = tree_hash(builder().build(references_of({&geometry, 1}, true), options_of(builder())));
    });
    return hash;
  };
  const uint64_t one = hash_with(1);
  EXPECT_EQ(hash_with(2), one);
  EXPECT_EQ(hash_with(7), one);
}

TEST_P(EveryBuilder, IdenticalReferencesAreHalved) {
  std::vector<Reference> same(100000, Reference{{0, 0, 0}, 0, {1, 1, 0}, 0});
  for (uint32_t i = 0; i < same.size(); ++i) same[i].primitive = i;
  const Bvh bvh = builder().build(std::move(same), options_of(builder()));
  const BvhStatistics statistics = measure(bvh);
  EXPECT_EQ(bvh.slots.size(), 100000U);
  EXPECT_LE(statistics.largest_leaf, 4U);
  EXPECT_LE(statistics.depth, 17U);
}

TEST(Builders, TheLeafDecisionFollowsTheCosts) {
  const RandomTriangles scene(2000);
  const Geometry geometry = scene.geometry();
  for (const BuilderEntry& builder : builders()) {
    const auto leaves = [&](double inner_cost) {
      return measure(
                 builder.build(references_of({&geometry, 1}, false), options_of(builder, {{"inner_cost", inner_cost}})))
          .leaves;
    };
    EXPECT_GT(leaves(0), 1900U) << builder.name;  // nodes for nothing: one reference a leaf wherever a plane divides
    EXPECT_LT(leaves(100), leaves(1)) << builder.name;
  }
}

TEST(Builders, MoreCandidatesGiveCheaperTrees) {
  const RandomTriangles scene(20000);
  const Geometry geometry = scene.geometry();
  const auto cost = [&](const char* name, const std::map<std::string, double>& given = {}) {
    for (const BuilderEntry& builder : builders()) {
      if (builder.name == name)
        return sah_cost(builder.build(references_of({&geometry, 1}, true), options_of(builder, given)));
    }
    ADD_FAILURE() << name;
    return 0.0;
  };
  const double sweep = cost("sweep_sah"), fine = cost("binned_sah"), coarse = cost("binned_sah", {{"planes", 8}});
  EXPECT_LE(sweep, fine * 1.01);
  EXPECT_LE(fine, coarse * 1.01);
  EXPECT_LE(coarse, cost("spatial_median") * 1.01);
  EXPECT_LE(coarse, cost("object_median") * 1.01);
  EXPECT_EQ(cost("binned_sah", {{"planes", 8}}), cost("binned_sah", {{"bins", 9}}));
}

const BuilderEntry& builder_named(std::string_view name) {
  for (const BuilderEntry& builder : builders()) {
    if (builder.name == name) return builder;
  }
  throw std::logic_error(std::string(name));
}

TEST(Builders, SeedsAndCandidatesOfRandomPlanes) {
  const RandomTriangles scene(5000);
  const Geometry geometry = scene.geometry();
  const BuilderEntry& builder = builder_named("random_top_down");
  const auto build = [&](double seed, double candidates) {
    return builder.build(references_of({&geometry, 1}, false),
                         options_of(builder, {{"seed", seed}, {"candidates", candidates}}));
  };
  EXPECT_EQ(tree_hash(build(1, 16)), tree_hash(build(1, 16)));
  EXPECT_NE(tree_hash(build(1, 16)), tree_hash(build(2, 16)));
  EXPECT_LT(sah_cost(build(1, 16)), sah_cost(build(1, 1)));
  EXPECT_LT(sah_cost(build(1, 128)), sah_cost(build(1, 4)));
}

TEST(Builders, InsertionBySeedOrderAndSearch) {
  const RandomTriangles scene(5000);
  const Geometry geometry = scene.geometry();
  const BuilderEntry& builder = builder_named("insertion");
  const auto build = [&](double search, double order, double seed) {
    return builder.build(references_of({&geometry, 1}, false),
                         options_of(builder, {{"search", search}, {"order", order}, {"seed", seed}}));
  };
  EXPECT_NE(tree_hash(build(1, 1, 1)), tree_hash(build(1, 1, 2)));
  EXPECT_EQ(tree_hash(build(1, 0, 1)), tree_hash(build(1, 0, 2)));  // the order given needs no seed
  EXPECT_LT(sah_cost(build(1, 1, 1)), 0.8 * sah_cost(build(0, 1, 1)));
}

TEST(Builders, InsertionOfBoxesInARowStaysShallow) {
  // Each next to the last: the given order is the worst, the way down gets long.
  std::vector<Reference> row(20000);
  for (uint32_t i = 0; i < row.size(); ++i) {
    const auto x = static_cast<float>(i);
    row[i] = {{x, 0, 0}, 0, {x + 0.5F, 1, 1}, i};
  }
  const BuilderEntry& builder = builder_named("insertion");
  for (const double search : {0, 1}) {
    for (const double order : {0, 1}) {
      const Bvh bvh = builder.build(row, options_of(builder, {{"search", search}, {"order", order}}));
      EXPECT_EQ(bvh.slots.size(), row.size());
      EXPECT_LE(measure(bvh).depth, kMaxDepth);
    }
  }
}

TEST(Builders, OversizeReferencesStayOnShelves) {
  // Twenty boxes as large as the scene among a thousand small ones.
  std::vector<Reference> references(1020);
  for (uint32_t i = 0; i < references.size(); ++i) {
    const Vec3f at{static_cast<float>(i % 10), static_cast<float>(i / 10 % 10), static_cast<float>(i / 100)};
    references[i] = {at, 0, at + Vec3f{0.5F, 0.5F, 0.5F}, i};
    if (i >= 1000) references[i] = {{0, 0, 0}, 0, {10, 10, 10 - 0.01F * at.x}, i};
  }
  const auto mixed_leaves = [&](const BuilderEntry& builder) {
    const Bvh bvh = builder.build(references, options_of(builder));
    size_t mixed = 0;
    for (const BvhNode& node : bvh.nodes) {
      size_t large = 0;
      for (uint32_t s = node.first; s < node.first + node.count; ++s) large += bvh.slots[s].primitive >= 1000 ? 1 : 0;
      mixed += large > 0 && large < node.count ? 1 : 0;
    }
    return mixed;
  };
  const BuilderEntry& shelves = builder_named("oversize_shelves");
  EXPECT_EQ(mixed_leaves(shelves), 0U);
  // Right below the root stand a shelf of twenty in five leaves and the thousand.
  const Bvh bvh = shelves.build(references, options_of(shelves));
  const BvhNode &rest = bvh.nodes[1], &shelf = bvh.nodes[2];
  EXPECT_LE(rest.upper.z, 9.5F + 1);
  EXPECT_EQ(shelf.upper.z, 10);
  EXPECT_EQ(shelf.lower, (Vec3f{0, 0, 0}));
}

TEST(Builders, TheChildWithMoreReferencesIsFirst) {
  const RandomTriangles scene(2000);
  const Geometry geometry = scene.geometry();
  for (const BuilderEntry& builder : builders()) {
    const Bvh bvh = builder.build(references_of({&geometry, 1}, false), options_of(builder));
    std::vector<uint32_t> count(bvh.nodes.size());
    for (size_t i = bvh.nodes.size(); i-- > 0;) {
      const BvhNode& node = bvh.nodes[i];
      if (node.is_leaf()) {
        count[i] = node.count;
        continue;
      }
      count[i] = count[node.first] + count[node.first + 1];
      ASSERT_GE(count[node.first], count[node.first + 1]) << builder.name;
    }
  }
}

TEST(Tree, FaultsAreFound) {
  const RandomTriangles scene(200);
  const Geometry geometry = scene.geometry();
  const auto fault_after = [&](auto&& damage) {
    Bvh bvh = build_binned_sah(references_of({&geometry, 1}, false), options_of(builders()[0]));
    damage(bvh);
    return find_fault(bvh, {&geometry, 1}, 4);
  };
  EXPECT_EQ(fault_after([](Bvh&) {}), std::nullopt);
  EXPECT_NE(fault_after([](Bvh& b) { b.nodes[1].lower.x += 1; }), std::nullopt);
  EXPECT_NE(fault_after([](Bvh& b) { b.nodes[0].upper.y += 1; }), std::nullopt);
  EXPECT_NE(fault_after([](Bvh& b) { b.slots[3].primitive = 200; }), std::nullopt);
  EXPECT_NE(fault_after([](Bvh& b) { b.slots[3].geometry_bits = 1; }), std::nullopt);
  EXPECT_NE(fault_after([](Bvh& b) { b.slots[3] = b.slots[4]; }), std::nullopt);
  EXPECT_NE(fault_after([](Bvh& b) { b.slots[3].geometry_bits |= LeafSlot::kRepeated; }), std::nullopt);
  EXPECT_NE(fault_after([](Bvh& b) { b.nodes[0].first = 3; }), std::nullopt);
  EXPECT_NE(fault_after([](Bvh& b) { b.slots.push_back({0, 0}); }), std::nullopt);
  EXPECT_NE(fault_after([](Bvh& b) { b.nodes.push_back(b.nodes.back()); }), std::nullopt);
}

TEST(Tree, CostOfATreeWorkedByHand) {
  // A root of area 22 over two unit cubes of area 6, with 2 and 1 slots: 1 + (6 * 2 + 6 * 1) / 22.
  Bvh bvh;
  bvh.nodes = {{{0, 0, 0}, 1, {1, 2, 3}, 0}, {{0, 0, 0}, 0, {1, 1, 1}, 2}, {{0, 1, 2}, 2, {1, 2, 3}, 1}};
  bvh.slots.resize(3);
  EXPECT_DOUBLE_EQ(sah_cost(bvh), 1 + 18.0 / 22);
  EXPECT_DOUBLE_EQ(sah_cost(bvh, 2, 0.5), 2 + 9.0 / 22);
  EXPECT_EQ(measure(bvh).depth, 1U);
  EXPECT_EQ(measure(bvh).leaves, 2U);
}

TEST(Tree, HashSeesEveryPart) {
  Bvh bvh;
  bvh.nodes = {{{0, 0, 0}, 0, {1, 1, 1}, 1}};
  bvh.slots = {{0, 7}};
  const uint64_t before = tree_hash(bvh);
  bvh.slots[0].primitive = 8;
  EXPECT_NE(tree_hash(bvh), before);
  bvh.slots[0] = {LeafSlot::kRepeated, 7};
  EXPECT_NE(tree_hash(bvh), before);
  bvh.slots[0] = {0, 7};
  EXPECT_EQ(tree_hash(bvh), before);
  bvh.nodes[0].upper.z = next_above(1.0F);
  EXPECT_NE(tree_hash(bvh), before);
}

}  // namespace
}  // namespace kerf
