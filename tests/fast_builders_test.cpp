// What the builders along a space-filling curve have of their own: cuts between its codes, who joins whom, trees of any
// depth made into a Bvh. The curve is in morton_order_test, what all builders promise in build_test.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>
#include <string_view>
#include <tuple>

#include "kerf/base/parallel.h"
#include "kerf/build/builders.h"
#include "kerf/build/clusters.h"
#include "kerf/build/join_tree.h"
#include "kerf/build/morton_order.h"
#include "tests/support/cubes.h"
#include "tests/support/property.h"
#include "tests/support/random.h"
#include "tests/support/random_scene.h"
#include "tests/support/sizes.h"

namespace kerf::test {
namespace {

const BuilderEntry& builder_named(std::string_view name) {
  return *std::find_if(builders().begin(), builders().end(), [&](const BuilderEntry& b) { return b.name == name; });
}

Bvh build(std::string_view name, std::vector<Reference> references,
          const std::vector<std::pair<const char*, double>>& given = {}) {
  const BuilderEntry& builder = builder_named(name);
  OptionValues options(builder.options);
  for (const auto& [option, value] : given) options.set(name, option, value);
  return builder.build({std::move(references)}, options);
}

Box3f centers_of(std::span<const Reference> references) {
  Box3f box;
  for (const Reference& r : references) box.extend(r.lower + r.upper);
  return box;
}

/// The rule of find_partners() as it is written: no two pairs are equal.
std::vector<uint32_t> partners_one_by_one(std::span<const Reference> references, uint32_t radius) {
  const auto count = static_cast<uint32_t>(references.size());
  std::vector<uint32_t> partners(count);
  for (uint32_t i = 0; i < count; ++i) {
    partners[i] = i;
    std::tuple<double, bool, uint32_t, uint32_t> least;
    for (uint32_t j = i - std::min(i, radius); j < std::min(count, i + radius + 1); ++j) {
      if (j == i) continue;
      const uint32_t lower = std::min(i, j), distance = std::max(i, j) - lower;
      const double area = half_area(united(references[i].bounds(), references[j].bounds()));
      const std::tuple key{area, (i ^ 1) != j, distance, lower};
      if (partners[i] == i || key < least) {
        least = key;
        partners[i] = j;
      }
    }
  }
  return partners;
}

TEST(Clusters, FindTheNearestAsOneByOne) {
  check_property(60, [] {
    // Small whole numbers: many ties, areas exact. The box around all is a cube with a power of two as its side.
    const int count = draw_int(0, 5) == 0 ? draw_int(4000, 5000) : draw_int(1, 700);
    const auto radius = static_cast<uint32_t>(draw_int(0, 3) == 0 ? draw_int(1, 256) : draw_int(1, 20));
    Random random(static_cast<uint64_t>(draw_int(0, 1 << 30)));
    std::vector<Reference> references;
    for (uint32_t i = 0; i < static_cast<uint32_t>(count); ++i) {
      const auto number = [&](uint32_t below) { return static_cast<float>(random.below(below)); };
      const Vec3f p{number(56), number(56), number(3)};
      references.push_back({p, 0, p + Vec3f{number(3), number(8), number(2)}, i});
    }
    references.push_back({{0, 0, 0}, 0, {64, 64, 64}, 0});
    std::vector<uint32_t> partners;
    const Clusters clusters(references);
    clusters.find_partners(radius, partners);
    RC_ASSERT(partners == partners_one_by_one(references, radius));
  });
}

TEST(Clusters, InARowOfEqualsAllHavePartners) {
  const std::vector<Reference> same(1000, cube_at({1, 2, 3}, 0));
  std::vector<uint32_t> partners;
  Clusters(same).find_partners(16, partners);
  for (uint32_t i = 0; i < 1000; ++i) ASSERT_EQ(partners[i], i ^ 1);
  Clusters(std::span(same).first(1)).find_partners(16, partners);
  EXPECT_EQ(partners, std::vector<uint32_t>{0});
}

/// The primitives below a node, in brackets: "((0 1) 2)".
std::string text_of(const Bvh& bvh, uint32_t node = 0) {
  const BvhNode& n = bvh.nodes[node];
  if (n.is_leaf()) {
    std::string text;
    for (uint32_t s = n.first; s < n.first + n.count; ++s) {
      text += (text.empty() ? "" : " ") + std::to_string(bvh.slots[s].primitive);
    }
    return text;
  }
  return "(" + text_of(bvh, n.first) + " " + text_of(bvh, n.first + 1) + ")";
}

TEST(Ploc, PairsWorkedByHand) {
  // Along a line at 0, 1, 3, 3.5 and 9. Round one: 2 and 3 are 1 wide together, 0 and 1 are 1.5 wide: two pairs, and 4
  // is left. Round two: 0 to 3 are 4 wide, 2 to 4 are 6.5 wide. Round three joins 4.
  std::vector<Reference> row;
  for (const float x : {0.0F, 1.0F, 3.0F, 3.5F, 9.0F})
    row.push_back(cube_at({x, 0, 0}, static_cast<uint32_t>(row.size())));
  const std::vector<std::pair<const char*, double>> single = {{"leaf", 1}};
  EXPECT_EQ(text_of(build("ploc", row, single)), "(((0 1) (2 3)) 4)");
  // Where 1 stands at 2, it is nearer to 2 than to 0, but 2 is nearest to 3: nobody's, as 0 is; round two joins 1 with
  // 2 and 3, which are 2 wide together, and 0 follows.
  row[1] = cube_at({2, 0, 0}, 1);
  EXPECT_EQ(text_of(build("ploc", row, single)), "((((2 3) 1) 0) 4)");
  // Of four in one leaf all are cheaper than nodes between them that cost a hundred tests.
  EXPECT_EQ(text_of(build("ploc", row, {{"leaf", 4}, {"inner_cost", 100}})), "(0 1 2 3 4)");
}

TEST(Ploc, BoxesThatStandFartherAndFartherApartTakeFewRounds) {
  // Each is nearest to the one before it, so that only the first two are each other's: one pair a round without a rule.
  constexpr double kGrowth = 1.0008;
  std::vector<Reference> row;
  for (uint32_t i = 0; i < 100000; ++i) {
    const auto x = static_cast<float>(std::pow(kGrowth, i));
    row.push_back(cube_at({x, 0, 0}, i, 1e-4F * x));
  }
  const BuilderEntry& ploc = builder_named("ploc");
  const Bvh bvh = ploc.build({row, {}, WorkLimit::seconds(20)}, OptionValues(ploc.options));
  EXPECT_EQ(bvh.slots.size(), row.size());
  EXPECT_LE(measure(bvh).depth, kMaxDepth);
}

TEST(Ploc, IsBetterThanBinnedSahWhereSizesDifferAndLittleWorseElsewhere) {
  const auto ratio = [](const char* name, float long_share) {
    const RandomTriangles scene(20000, 1, long_share);
    const Geometry geometry = scene.geometry();
    const std::vector<Reference> references = make_references({&geometry, 1}).references;
    return sah_cost(build(name, references)) / sah_cost(build("binned_sah", references));
  };
  EXPECT_LE(ratio("ploc", 0.2F), 1);
  EXPECT_LE(ratio("ploc", 0), 1.12);
  EXPECT_LE(ratio("lbvh", 0.2F), 1.6);
  EXPECT_LE(ratio("lbvh", 0), 1.12);
}

/// Every inner node parts its references where the highest bit in which their codes differ changes.
void check_cuts(const Bvh& bvh, const std::vector<Reference>& references) {
  const MortonGrid grid(centers_of(references));
  struct Range {
    uint64_t least = ~uint64_t{0}, most = 0;
  };
  std::vector<Range> ranges(bvh.nodes.size());
  for (size_t i = bvh.nodes.size(); i-- > 0;) {
    const BvhNode& node = bvh.nodes[i];
    if (node.is_leaf()) {
      ASSERT_EQ(node.count, 1U);
      ranges[i].least = ranges[i].most = grid.code(references[bvh.slots[node.first].primitive]);
      continue;
    }
    Range a = ranges[node.first], b = ranges[node.first + 1];
    if (b.least < a.least) std::swap(a, b);
    const uint64_t bit = std::bit_floor(a.least ^ b.most);
    ASSERT_EQ(a.most & bit, 0U);
    ASSERT_NE(b.least & bit, 0U);
    ranges[i] = {a.least, b.most};
  }
}

TEST(Lbvh, CutsAtTheHighestDifferingBit) {
  Random random(6);
  std::vector<Reference> references(3000);
  for (uint32_t i = 0; i < references.size(); ++i) references[i] = cube_at(random.vector(), i, 0.1F);
  check_cuts(build("lbvh", references, {{"leaf", 1}}), references);
}

TEST(Lbvh, KeepsTheDepthBoundWhereEachBitTakesOneReferenceOff) {
  // One reference for each bit of a code, the highest first, and twenty thousand in the cell that is left: 63 levels
  // and 15 more.
  std::vector<Reference> references;
  for (uint32_t bit = 0; bit <= kMortonBits; ++bit) {
    for (uint32_t axis = 0; axis < 3; ++axis) {
      Vec3f p;
      p[axis] = std::ldexp(1.0F, -static_cast<int>(bit));
      references.push_back(cube_at(p, static_cast<uint32_t>(references.size()), 0));
    }
  }
  for (int i = 0; i < 20000; ++i) references.push_back(cube_at({}, static_cast<uint32_t>(references.size()), 0));
  const MortonOrder order = morton_order(references, {});
  EXPECT_EQ(order.codes[20000], 1U) << "the codes are not those meant";
  for (const char* name : {"lbvh", "ploc"}) {
    for (const uint32_t leaf : {1U, 4U}) {
      const Bvh bvh = build(name, references, {{"leaf", leaf}});
      EXPECT_EQ(bvh.slots.size(), references.size());
      EXPECT_LE(measure(bvh).depth, kMaxDepth) << name;
      EXPECT_LE(measure(bvh).largest_leaf, leaf) << name;
    }
  }
}

/// A triangle for each number, in a row.
struct Row {
  std::vector<Vec3f> vertices;
  std::vector<TriangleCorners> triangles;

  explicit Row(uint32_t count) {
    for (uint32_t i = 0; i < count; ++i) {
      const auto x = static_cast<float>(i);
      vertices.insert(vertices.end(), {{x, 0, 0}, {x + 0.5F, 0, 0}, {x, 1, 0.25F}});
      triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
  }
  Geometry geometry() const { return {TriangleMesh{std::span(vertices), std::span(triangles)}}; }
};

TEST(JoinTree, OfAnyDepthBecomesATreeWithinTheBound) {
  const Row row(30000);
  const Geometry geometry = row.geometry();
  JoinTree chain;
  chain.references = make_references({&geometry, 1}).references;
  const auto count = static_cast<uint32_t>(chain.references.size());
  for (uint32_t i = 1; i < count; ++i) chain.joins.push_back({i == 1 ? 0 : chain.part(i - 2), i, i + 1, 0});
  chain.root = chain.part(count - 2);
  for (const uint32_t depth : {13U, 14U, 20U, 64U}) {
    for (const uint32_t leaf : {4U, 255U}) {
      TopDownOptions options;
      options.leaf_size = leaf;
      options.max_depth = depth;
      const Bvh bvh = make_bvh(chain, options, {});
      EXPECT_EQ(find_fault(bvh, {&geometry, 1}, leaf, depth), std::nullopt) << depth;
    }
  }
  // What can stay of it does: with 64 levels the first take one reference off each.
  const Bvh bvh = make_bvh(chain, {}, {});
  EXPECT_EQ(bvh.nodes[2].count, 1U);
  EXPECT_EQ(bvh.slots[bvh.nodes[2].first].primitive, count - 1);
}

TEST(JoinTree, LeavesFollowTheCost) {
  // Two unit squares side by side, each a pair of two: a leaf of two costs 2 areas, a node over two leaves 1 + 1 + 1.
  const auto square = [](float x, uint32_t primitive) { return Reference{{x, 0, 0}, 0, {x + 1, 1, 0}, primitive}; };
  JoinTree tree;
  tree.references = {square(0, 0), square(0, 1), square(5, 2), square(5, 3)};
  tree.joins = {{0, 1, 2, 0}, {2, 3, 2, 0}, {4, 5, 4, 0}};
  tree.root = 6;
  EXPECT_EQ(text_of(make_bvh(tree, {}, {})), "(0 1 2 3)");
  // All in one leaf: 4 * 6 = 24 against 6 for the node and 2 for each leaf, 10; at a cost of 20 for a node it pays.
  TopDownOptions dear;
  dear.inner_cost = 20;
  EXPECT_EQ(text_of(make_bvh(tree, dear, {})), "0 1 2 3");
  TopDownOptions free;
  free.inner_cost = 0;
  tree.references[1].upper.x = 0.5F;  // else a leaf costs as much
  EXPECT_EQ(text_of(make_bvh(tree, free, {})), "((0 1) 2 3)");
}

TEST(FastBuilders, TheOrderOfTheReferencesDoesNotMatter) {
  const RandomTriangles scene(5000);
  const Geometry geometry = scene.geometry();
  const std::vector<Reference> references = make_references({&geometry, 1}).references;
  std::vector<Reference> shuffled = references;
  shuffle(shuffled, 8);
  for (const char* name : {"lbvh", "ploc"}) {
    const Bvh a = build(name, references), b = build(name, shuffled);
    EXPECT_EQ(a.nodes, b.nodes) << name;
    EXPECT_EQ(a.slots, b.slots) << name;
  }
}

TEST(FastBuilders, AreTheSameToTheByteForAnyNumberOfThreads) {
  const RandomTriangles scene(kManyThings * 3 / 2);
  const Geometry geometry = scene.geometry();
  const std::vector<Reference> references = make_references({&geometry, 1}).references;
  const auto bytes = [&](const char* name, double radius, int threads) {
    Bvh bvh;
    with_threads(threads, [&] {
      bvh = radius > 0 ? build(name, references, {{"radius", radius}}) : build(name, references);
    });
    std::string all(bvh.bytes(), '\0');
    std::memcpy(all.data(), bvh.nodes.data(), bvh.nodes.size() * sizeof(BvhNode));
    std::memcpy(all.data() + bvh.nodes.size() * sizeof(BvhNode), bvh.slots.data(), bvh.slots.size() * sizeof(LeafSlot));
    return all;
  };
  for (const auto& [name, radius] : {std::pair{"lbvh", 0.0}, {"ploc", 1.0}, {"ploc", 16.0}, {"ploc", 100.0}}) {
    const std::string one = bytes(name, radius, 1);
    EXPECT_TRUE(bytes(name, radius, 2) == one) << name << radius;
    EXPECT_TRUE(bytes(name, radius, 7) == one) << name << radius;
  }
}

}  // namespace
}  // namespace kerf::test
