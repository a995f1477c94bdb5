// Early split clipping: bounds, cover, caps, limits, and the same outcome always.

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <map>
#include <numeric>
#include <vector>

#include "kerf/base/error.h"
#include "kerf/base/parallel.h"
#include "kerf/choose/splitters.h"
#include "kerf/geometry/clip.h"
#include "kerf/references/split_references.h"
#include "tests/support/error_of.h"
#include "tests/support/exact.h"
#include "tests/support/property.h"
#include "tests/support/random.h"
#include "tests/support/soup.h"

namespace kerf::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

SplitResult split(const Geometry& geometry, const EarlySplit& options) {
  const std::span<const Geometry> geometries(&geometry, 1);
  return early_split(make_references(geometries).references, geometry_clipper(geometries), options);
}

SplitResult split(const Soup& soup, const EarlySplit& options) { return split(Geometry{soup.mesh()}, options); }

/// Whether a box could be cut in the middle of its longest side.
bool can_be_cut(const Box3f& box) {
  const uint32_t axis = largest_axis(box.extent());
  const float middle = center(box, axis);
  return box.lower[axis] < middle && middle < box.upper[axis];
}

bool same_bytes(const std::vector<Reference>& a, const std::vector<Reference>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Reference)) == 0;
}

TEST(EarlySplit, InfiniteSaMaxGivesThePlainList) {
  const Soup soup = random_soup(3000, 1);
  const SplitResult result = split(soup, {});
  const Geometry geometry{soup.mesh()};
  EXPECT_EQ(result.references, make_references({&geometry, 1}).references);
  EXPECT_EQ(result.limit, kInfinity);
  EXPECT_FALSE(result.capped);
}

TEST(EarlySplit, RefusesWhatCannotBeMeant) {
  const Soup soup = random_soup(3, 1);
  for (const double sa_max : {0.0, -0.0, -1.0, -kInfinity, kNaN}) {
    error_of(ErrorCode::invalid_option, [&] { split(soup, {.sa_max = sa_max}); });
  }
  for (const double cap : {0.999, 0.0, -1.0, kNaN}) {
    error_of(ErrorCode::invalid_option, [&] { split(soup, {.sa_max = 1, .cap = cap}); });
  }
  EXPECT_EQ(split(soup, {.sa_max = 1e-3, .cap = 1}).references.size(), 3U);
}

TEST(EarlySplit, NothingToSplitIsNoTrouble) {
  const Soup empty;
  for (const double cap : {1.0, 16.0, kInfinity}) {
    const SplitResult result = split(empty, {.sa_max = 1, .cap = cap});
    EXPECT_TRUE(result.references.empty());
    EXPECT_FALSE(result.capped);
  }
}

TEST(EarlySplit, NoReferenceIsLargerThanAllowedAndTheCallersNumbersStay) {
  const Soup soup = random_soup(2000, 2);
  for (const double sa_max : {300.0, 10.0, 1.0}) {
    const SplitResult result = split(soup, {.sa_max = sa_max, .cap = kInfinity});
    EXPECT_EQ(result.limit, sa_max);
    EXPECT_FALSE(result.capped);
    std::vector<uint32_t> seen;
    for (const Reference& r : result.references) {
      EXPECT_LE(surface_area(r.bounds()), sa_max);
      EXPECT_EQ(r.geometry, 0U);
      if (seen.empty() || seen.back() != r.primitive) seen.push_back(r.primitive);
    }
    std::vector<uint32_t> all(soup.triangles.size());
    std::iota(all.begin(), all.end(), 0U);
    EXPECT_EQ(seen, all) << "in the caller's order, pieces side by side";
  }
}

TEST(EarlySplit, PiecesCoverTheTriangleAndEachIsItsPartOfTheOriginal) {
  check_property(300, [] {
    Soup soup;
    Triangle t{draw_vector(), draw_vector(), draw_vector()};
    if (draw_int(0, 2) == 0) t.c = t.a + draw_share() * (t.b - t.a) + 1e-4F * t.c;
    if (draw_int(0, 2) == 0) t.a.y = t.b.y = t.c.y;
    soup.add(t);
    RC_PRE(!is_degenerate(Geometry{soup.mesh()}, 0));
    const double area = surface_area(primitive_bounds(Geometry{soup.mesh()}, 0));
    const std::vector<Reference> pieces = split(soup, {.sa_max = area / draw_int(2, 60), .cap = 1e6}).references;
    const std::array<Vec3d, 3> corners{to_double(t.a), to_double(t.b), to_double(t.c)};
    for (const Reference& piece : pieces) {
      const Box3f again = clipped_bounds(corners, piece.bounds());
      for (uint32_t axis = 0; axis < 3; ++axis) {  // clipping to the box once more takes off no more than its rounding
        RC_ASSERT(again.lower[axis] <= piece.lower[axis] + 0x1p-22F &&
                  again.upper[axis] >= piece.upper[axis] - 0x1p-22F);
      }
    }
    for (int i = 0; i < 60; ++i) {
      Real u = draw_share(), v = i % 4 == 0 ? 0 : draw_share();
      if (u + v > 1) u = 1 - u, v = 1 - v;
      const Vec3r p = to_real(t.a) + u * to_real(t.b - t.a) + v * to_real(t.c - t.a);
      // t.b - t.a is rounded; so the point is off the triangle by a float's rounding, and may be off the boxes by it.
      const bool covered = std::any_of(pieces.begin(), pieces.end(), [&](const Reference& r) {
        const Vec3r off = max(to_real(r.lower) - p, p - to_real(r.upper));
        return largest(off) <= 0x1p-22L;
      });
      RC_ASSERT(covered);
    }
  });
}

/// Splits as the paper's Algorithm 4 says, with nothing of the library but the clipping of the original triangle.
void split_by_the_paper(std::span<const Vec3d> corners, const Box3f& box, double sa_max, std::vector<Box3f>& out) {
  if (surface_area(box) <= sa_max || !can_be_cut(box)) return out.push_back(box);
  const uint32_t axis = largest_axis(box.extent());
  const auto [below, above] = cut_bounds(corners, box, axis, center(box, axis));
  if (!below.is_empty()) split_by_the_paper(corners, below, sa_max, out);
  if (!above.is_empty()) split_by_the_paper(corners, above, sa_max, out);
}

TEST(EarlySplit, IsThePapersAlgorithm4OnTheOriginalAlsoUnderACap) {
  const Soup soup = random_soup(300, 3);
  for (const EarlySplit& options : {EarlySplit{1, 1e9}, EarlySplit{0.1, 1e9}, EarlySplit{0.1, 3}}) {
    const SplitResult result = split(soup, options);
    std::vector<Box3f> boxes, expected;
    for (const Reference& r : result.references) boxes.push_back(r.bounds());
    for (uint32_t i = 0; i < soup.triangles.size(); ++i) {
      const Triangle t = soup.triangle(i);
      const std::array<Vec3d, 3> corners{to_double(t.a), to_double(t.b), to_double(t.c)};
      split_by_the_paper(corners, primitive_bounds(Geometry{soup.mesh()}, i), result.limit, expected);
    }
    EXPECT_EQ(boxes, expected);
  }
}

TEST(EarlySplit, EndsOnWhateverItIsGiven) {
  Soup soup;
  soup.add({{0, 0, 0}, {1e6F, 1, 0}, {1e6F, 1 + 1e-6F, 1e-6F}});                           // sliver
  soup.add({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}});                                             // dropped before
  soup.add({{1e30F, -1e30F, 0}, {-1e30F, 1e30F, 0}, {0, 0, 1e30F}});                       // huge
  soup.add({{1e30F, 0, 0}, {std::nextafter(1e30F, 2e30F), 1e20F, 0}, {1e30F, 0, 1e20F}});  // one ulp wide
  soup.add({{1e-42F, 0, 0}, {0, 1e-42F, 0}, {0, 0, 1e-45F}});                              // denormal
  for (const double sa_max : {1e-30, 1e-300, std::numeric_limits<double>::denorm_min()}) {
    for (const double cap : {1.0, 50.0, 1000.0}) {
      const SplitResult result = split(soup, {.sa_max = sa_max, .cap = cap});
      EXPECT_LE(result.references.size(), static_cast<size_t>(4 * cap));
      EXPECT_TRUE(result.capped);
      EXPECT_GE(result.limit, sa_max);
    }
  }
  Soup tiny;  // few floats to cut at, so it ends by itself
  tiny.add({{0, 0, 0}, {4e-45F, 0, 0}, {0, 4e-45F, 0}});
  const SplitResult result = split(tiny, {.sa_max = 1e-300, .cap = 1e6});
  EXPECT_FALSE(result.capped);
  for (const Reference& r : result.references) EXPECT_FALSE(can_be_cut(r.bounds()));
}

TEST(EarlySplit, TheCapHoldsAndTheLimitUsedIsTheSmallestThatFits) {
  for (const uint64_t seed : {4, 5, 6}) {
    const Soup soup = random_soup(1500, seed);
    for (const double asked : {2.0, 5.0, 20.0, 60.0, 150.0}) {
      const size_t wanted = split(soup, {.sa_max = asked, .cap = 1e9}).references.size();
      for (const double share : {0.3, 0.7, 0.95}) {
        // A cap between one reference per triangle and what the limit asks for: all sizes, so that one or two large
        // steps lead from the largest box down, or none.
        const double cap = 1 + share * (static_cast<double>(wanted) / 1500 - 1);
        const auto most = static_cast<size_t>(std::floor(cap * 1500));
        const SplitResult result = split(soup, {.sa_max = asked, .cap = cap});
        EXPECT_TRUE(result.capped);
        EXPECT_LE(result.references.size(), most);
        EXPECT_GT(result.limit, asked);
        EXPECT_TRUE(same_bytes(result.references, split(soup, {.sa_max = result.limit, .cap = 1e9}).references));
        const size_t finer = split(soup, {.sa_max = result.limit * 0.999, .cap = 1e9}).references.size();
        const bool is_full = static_cast<double>(result.references.size()) >= 0.999 * static_cast<double>(most);
        EXPECT_TRUE(finer > most || is_full) << "sa_max " << result.limit << " for " << asked << ", cap " << cap << ": "
                                             << result.references.size() << " of " << most;
      }
      EXPECT_FALSE(split(soup, {.sa_max = asked, .cap = std::ceil(static_cast<double>(wanted) / 1500)}).capped);
    }
  }
}

TEST(EarlySplit, ABudgetIsUsedUpToOnePercent) {
  const Soup soup = random_soup(4000, 7);
  for (const double budget : {1.2, 1.5, 2.0}) {
    const auto count = static_cast<double>(split(soup, EarlySplit::with_budget(budget)).references.size());
    EXPECT_LE(count, budget * 4000);
    EXPECT_GE(count, 0.99 * budget * 4000);
  }
}

TEST(EarlySplit, TheOrderOfPrimitivesDoesNotMatter) {
  const Soup soup = random_soup(2500, 8);
  Soup shuffled;
  std::vector<uint32_t> from(soup.triangles.size());
  std::iota(from.begin(), from.end(), 0U);
  Random random(9);
  for (size_t i = from.size() - 1; i > 0; --i) std::swap(from[i], from[random.below(static_cast<uint32_t>(i) + 1)]);
  for (const uint32_t i : from) shuffled.add(soup.triangle(i));
  for (const EarlySplit& options : {EarlySplit{2, 1e9}, EarlySplit{0.01, 3}, EarlySplit::with_budget(1.5)}) {
    const SplitResult a = split(soup, options), b = split(shuffled, options);
    EXPECT_EQ(a.limit, b.limit);
    std::map<uint32_t, std::vector<Box3f>> pieces_a, pieces_b;
    for (const Reference& r : a.references) pieces_a[r.primitive].push_back(r.bounds());
    for (const Reference& r : b.references) pieces_b[from[r.primitive]].push_back(r.bounds());
    EXPECT_EQ(pieces_a, pieces_b);
  }
}

TEST(EarlySplit, TheNumberOfThreadsDoesNotMatter) {
  const Soup soup = random_soup(6000, 10);  // several blocks of work
  for (const EarlySplit& options : {EarlySplit{2, 1e9}, EarlySplit{0.01, 3}, EarlySplit::with_budget(1.2)}) {
    SplitResult one, many;
    with_threads(1, [&] { one = split(soup, options); });
    for (const int threads : {2, 7}) {
      with_threads(threads, [&] { many = split(soup, options); });
      EXPECT_TRUE(same_bytes(one.references, many.references));
      EXPECT_EQ(one.limit, many.limit);
      EXPECT_EQ(one.capped, many.capped);
    }
  }
}

TEST(EarlySplit, SpheresKeepOnlyTheirSurface) {
  const Sphere sphere{{1, 2, 3}, 4};
  const auto pieces = split(Geometry{Strided<Sphere>(&sphere, 1)}, {.sa_max = 1, .cap = 1e9}).references;
  EXPECT_GT(pieces.size(), 100U);
  for (const Reference& r : pieces) {
    EXPECT_FALSE(
        clip_exactly(sphere, {r.lower - Vec3f{1e-5F, 1e-5F, 1e-5F}, r.upper + Vec3f{1e-5F, 1e-5F, 1e-5F}}).is_empty());
  }
  Random random(11);
  for (int i = 0; i < 2000; ++i) {
    const Vec3r direction = to_real(random.vector());
    const Vec3r p = to_real(sphere.center) + direction * (4 / length(direction));
    EXPECT_TRUE(std::any_of(pieces.begin(), pieces.end(), [&](const Reference& r) {
      return largest(max(to_real(r.lower) - p, p - to_real(r.upper))) <= 1e-17L;
    })) << i;
  }
}

TEST(EarlySplit, ParallelogramsAreCoveredToo) {
  const Parallelogram shape{{1, 0, 0}, {3, 1, 0.5F}, {-1, 2, 4}};
  const auto pieces = split(Geometry{Strided<Parallelogram>(&shape, 1)}, {.sa_max = 2, .cap = 1e9}).references;
  EXPECT_GT(pieces.size(), 10U);
  Random random(12);
  for (int i = 0; i < 2000; ++i) {
    const Real a = random.share(), b = random.share();
    const Vec3r p = to_real(shape.corner) + a * to_real(shape.u) + b * to_real(shape.v);
    EXPECT_TRUE(std::any_of(pieces.begin(), pieces.end(), [&](const Reference& r) {
      return largest(max(to_real(r.lower) - p, p - to_real(r.upper))) <= 1e-17L;
    })) << i;
  }
}

TEST(EarlySplit, TheMenusBudgetReplacesBothLimits) {
  const SplitterEntry& entry = splitters()[0];
  ASSERT_EQ(entry.name, "early_split");
  const Soup soup = random_soup(500, 13);
  const Geometry geometry{soup.mesh()};
  const std::span<const Geometry> geometries(&geometry, 1);
  const PrimitiveReferences whole = make_references(geometries);
  OptionValues options(entry.options);
  options.set("early_split", "budget", 1.5);
  const SplitResult result = entry.split({geometries, whole.references, geometry_clipper(geometries), {}}, options);
  EXPECT_TRUE(same_bytes(result.references, split(soup, EarlySplit::with_budget(1.5)).references));
  EXPECT_FALSE(result.capped) << "no limit was asked for, so none was raised";
  options.set("early_split", "cap", 3);
  error_of(ErrorCode::invalid_option, [&] {
    entry.split({geometries, whole.references, geometry_clipper(geometries), {}}, options);
  });
}

TEST(SplitReferences, AreThoseOfTheMesh) {
  const Soup soup = random_soup(500, 14);
  EXPECT_EQ(split_references(soup.mesh()).size(), 500U);
  const std::vector<Reference> pieces = split_references(soup.mesh(), EarlySplit::with_budget(1.5));
  EXPECT_TRUE(same_bytes(pieces, split(soup, EarlySplit::with_budget(1.5)).references));
  Soup bad = soup;
  bad.vertices[7].y = std::nanf("");
  bad.triangles[400][1] = 999999;
  const std::string text = error_of(ErrorCode::invalid_geometry, [&] { split_references(bad.mesh()); });
  EXPECT_EQ(split_references(bad.mesh(), {}, true).size(), 498U);
  EXPECT_NE(text.find("triangle 2"), std::string::npos) << text;
}

TEST(EarlySplit, GivesUpAtItsLimit) {
  const Soup soup = random_soup(2000, 3);
  const std::vector<Geometry> geometries{{soup.mesh()}};
  const std::span<const Geometry> all = geometries;
  const std::vector<Reference> whole = make_references(all).references;
  const auto stops = [&](const EarlySplit& options, const WorkLimit& limit) {
    error_of(ErrorCode::stopped, [&] { early_split(whole, geometry_clipper(all), options, limit); });
  };
  const std::atomic<bool> cancelled = true;
  WorkLimit unwanted, late, small, tiny;
  unwanted.cancelled = &cancelled;
  late.deadline = WorkLimit::Clock::now();
  small.bytes = 3 * whole.size() * sizeof(Reference);  // enough for the references, not for their pieces
  tiny.bytes = 1000;
  for (const EarlySplit& options : {EarlySplit::with_budget(8), EarlySplit{0.01, 1000}}) {
    for (const WorkLimit& limit : {unwanted, late, small, tiny}) stops(options, limit);
  }
  stops({}, tiny);  // which would copy them all
  EXPECT_GT(early_split(whole, geometry_clipper(all), EarlySplit::with_budget(2), small).references.size(),
            whole.size());
}

TEST(EarlySplit, IsStoppedWithinOnePrimitive) {
  const std::vector<Reference> one{{{0, 0, 0}, 0, {1, 1, 1}, 0}};
  std::atomic<bool> cancelled = false;
  struct Cutter {
    std::atomic<bool>* cancelled;
    int cuts = 0;
  } cutter{&cancelled};
  // Nothing is ever empty, and the work is not wanted any more after a thousand cuts.
  const Clipper clipper{[](const void* data, const Reference& reference, uint32_t axis, float position) {
                          auto& c = *static_cast<Cutter*>(const_cast<void*>(data));
                          if (++c.cuts == 1000) *c.cancelled = true;
                          ClippedBoxes boxes{reference.bounds(), reference.bounds()};
                          boxes.below.upper[axis] = boxes.above.lower[axis] = position;
                          return boxes;
                        },
                        &cutter};
  WorkLimit limit;
  limit.cancelled = &cancelled;
  error_of(ErrorCode::stopped, [&] { early_split(one, clipper, {1e-30, 1e6}, limit); });
  EXPECT_LT(cutter.cuts, 2000);
}

TEST(EarlySplit, MayBeginWithinAnother) {
  // As where a callback builds something else: here the clipper splits another primitive before each cut.
  const std::vector<Reference> one{{{0, 0, 0}, 0, {1, 1, 1}, 0}}, other{{{0, 0, 0}, 0, {1, 1, 1}, 1}};
  struct Cutter {
    const std::vector<Reference>& other;
    bool is_nested = false;
    int pieces = 0;
  } cutter{other};
  const Clipper clipper{[](const void* data, const Reference& reference, uint32_t axis, float position) {
                          auto& c = *static_cast<Cutter*>(const_cast<void*>(data));
                          if (c.is_nested && reference.primitive == 0) early_split(c.other, {}, {1e6});
                          ClippedBoxes boxes{reference.bounds(), reference.bounds()};
                          boxes.below.upper[axis] = boxes.above.lower[axis] = position;
                          return boxes;
                        },
                        &cutter};
  const auto pieces = [&] { return early_split(one, clipper, {0.1, 1000}).references.size(); };
  const size_t alone = pieces();
  EXPECT_GT(alone, 10U);
  cutter.is_nested = true;
  EXPECT_EQ(pieces(), alone);
}

}  // namespace
}  // namespace kerf::test
