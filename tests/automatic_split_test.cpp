// Automatic splitting: what it cuts and leaves, its cap, that pieces cover their primitive, the same outcome always.

#include "kerf/choose/automatic_split.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <vector>

#include "kerf/base/error.h"
#include "kerf/base/parallel.h"
#include "kerf/scene/pipeline.h"
#include "kerf/scene/scene.h"
#include "tests/support/error_of.h"
#include "tests/support/meshes.h"
#include "tests/support/random.h"
#include "tests/support/soup.h"

namespace kerf::test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Long thin triangles in all directions, among many small ones.
Soup needles_in_hay(size_t needles, size_t straws, uint64_t seed, float scale = 1, uint32_t turn = 0) {
  Random random(seed);
  const auto placed = [&](Vec3f p) {
    Vec3f q;
    for (uint32_t axis = 0; axis < 3; ++axis) q[(axis + turn) % 3] = scale * p[axis];
    return q;
  };
  Soup soup;
  for (size_t i = 0; i < needles + straws; ++i) {
    const Vec3f at = 10.0F * random.vector();
    const float length = i < needles ? 8.0F : 0.1F, width = i < needles ? 0.05F : 0.1F;
    const Vec3f along = length * random.vector(), across = width * random.vector();
    soup.add(placed(at), placed(at + along), placed(at + across));
  }
  return soup;
}

SplitResult split(const Geometry& geometry, const AutomaticSplit& options = {}) {
  const std::span<const Geometry> geometries(&geometry, 1);
  const PrimitiveReferences whole = make_references(geometries);
  return split_automatically({geometries, whole.references, geometry_clipper(geometries), {}}, options);
}

SplitResult split(const Soup& soup, const AutomaticSplit& options = {}) {
  return split(Geometry{soup.mesh()}, options);
}

double share(const SplitResult& result, const Soup& soup) {
  return static_cast<double>(result.references.size()) / static_cast<double>(soup.triangles.size());
}

bool same_bytes(const std::vector<Reference>& a, const std::vector<Reference>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Reference)) == 0;
}

TEST(AutomaticSplit, NothingAndNextToNothing) {
  EXPECT_TRUE(split(Soup{}).references.empty());
  EXPECT_FALSE(split(Soup{}).choice->reason.empty());
  Soup one;
  one.add({0, 0, 0}, {1, 2, 3}, {3, 1, 1});
  EXPECT_EQ(split(one).references.size(), 1U) << "nothing overlaps with it";
}

TEST(AutomaticSplit, EqualTrianglesStayWhole) {
  Soup soup;
  for (int i = 0; i < 100000; ++i) soup.add({0, 0, 0}, {1, 2, 3}, {3, 1, 1});
  EXPECT_LE(split(soup).references.size(), 200000U);
  EXPECT_GE(split(soup).references.size(), 100000U);
}

TEST(AutomaticSplit, LeavesAWellShapedMesh) {
  const PlacedSolid ball = place(icosphere(6), 1, {0, 0, 0});
  const SplitResult result = split(Geometry{ball.mesh()});
  EXPECT_EQ(result.references.size(), ball.triangles.size()) << "though the guide's planes would cut some";
  EXPECT_EQ(result.choice->reason.find("nothing is cut"), 0U) << result.choice->reason;
  EXPECT_EQ(result.choice->curve.size(), 1U);
}

TEST(AutomaticSplit, LeavesAStraightGrid) {
  Soup soup;  // a chequered floor: its boxes fill it
  for (int x = 0; x < 60; ++x) {
    for (int z = 0; z < 60; ++z) {
      const auto a = static_cast<float>(x), b = static_cast<float>(z);
      soup.add({a, 0, b}, {a + 1, 0, b}, {a + 1, 0, b + 1});
      soup.add({a, 0, b}, {a + 1, 0, b + 1}, {a, 0, b + 1});
    }
  }
  EXPECT_EQ(share(split(soup), soup), 1);
}

TEST(AutomaticSplit, CutsWhatIsLongAndAskew) {
  const Soup soup = needles_in_hay(400, 20000, 1);
  const SplitResult result = split(soup);
  size_t needles = 0;
  for (const Reference& reference : result.references) needles += reference.primitive < 400 ? 1 : 0;
  EXPECT_GE(needles, 2000U) << "pieces of 400";
  EXPECT_LE(result.references.size() - needles, 20400U) << "the small ones stay whole, but for a few";
  EXPECT_FALSE(result.capped);
  EXPECT_TRUE(is_automatic(result.limit)) << "there is no one limit";
}

TEST(AutomaticSplit, ReferencesStandInTheCallersOrder) {
  const Soup soup = needles_in_hay(200, 2000, 2);
  const std::vector<Reference> all = split(soup).references;
  EXPECT_TRUE(std::is_sorted(all.begin(), all.end(),
                             [](const Reference& a, const Reference& b) { return a.primitive < b.primitive; }));
}

TEST(AutomaticSplit, PiecesCoverTheirTriangle) {
  const Soup soup = needles_in_hay(300, 3000, 3);
  const std::vector<Reference> all = split(soup).references;
  Random random(4);
  size_t at = 0;
  for (uint32_t i = 0; i < soup.triangles.size(); ++i) {
    const size_t begin = at;
    while (at < all.size() && all[at].primitive == i) ++at;
    ASSERT_GT(at, begin) << "triangle " << i << " is lost";
    const std::span<const Reference> pieces(all.data() + begin, at - begin);
    const Triangle t = soup.mesh().triangle(i);
    for (int k = 0; k < 20; ++k) {
      const double a = random.share(), b = random.share() * (1 - a);
      const Vec3d p = to_double(t.a) + a * (to_double(t.b) - to_double(t.a)) + b * (to_double(t.c) - to_double(t.a));
      EXPECT_TRUE(std::any_of(pieces.begin(), pieces.end(), [&](const Reference& r) {
        return largest(max(to_double(r.lower) - p, p - to_double(r.upper))) <= 1e-12;
      })) << i;
    }
  }
}

TEST(AutomaticSplit, HonoursItsCap) {
  const Soup soup = needles_in_hay(3000, 3000, 5);
  const double free = share(split(soup, {100}), soup);
  ASSERT_GT(free, 2) << "else the caps below are none";
  double last = 1;
  for (const double cap : {1.0, 1.05, 1.2, 1.5, 2.0, 3.0}) {
    const SplitResult result = split(soup, {cap});
    EXPECT_LE(share(result, soup), cap);
    EXPECT_GE(share(result, soup), last) << "more room, more pieces";
    EXPECT_EQ(result.capped, cap < free) << cap;
    const double wanted = cap >= 1.2 ? 1 + 0.5 * (std::min(cap, free) - 1) : 1;
    EXPECT_GE(share(result, soup), wanted) << "room is left: " << cap;
    last = share(result, soup);
  }
}

TEST(AutomaticSplit, RefusesACapBelowOne) {
  const Soup soup = needles_in_hay(10, 10, 6);
  for (const double cap : {0.99, 0.0, -1.0, kNaN}) {
    error_of(ErrorCode::invalid_option, [&] { split(soup, {cap}); });
  }
}

TEST(AutomaticSplit, StopsAtTheLimit) {
  const Soup soup = needles_in_hay(1000, 4000, 7);
  const Geometry geometry{soup.mesh()};
  const std::span<const Geometry> geometries(&geometry, 1);
  const PrimitiveReferences whole = make_references(geometries);
  std::atomic<bool> cancelled = true;
  WorkLimit limit;
  limit.cancelled = &cancelled;
  error_of(ErrorCode::stopped, [&] {
    split_automatically({geometries, whole.references, geometry_clipper(geometries), limit});
  });
  WorkLimit small;
  small.bytes = 1000;
  error_of(ErrorCode::stopped, [&] {
    split_automatically({geometries, whole.references, geometry_clipper(geometries), small});
  });
}

TEST(AutomaticSplit, CanBeStoppedWhereNothingDividesThem) {
  Soup soup;
  for (int i = 0; i < 200000; ++i) soup.add({0, 0, 0}, {1, 2, 3}, {3, 1, 1});
  const Geometry geometry{soup.mesh()};
  const std::span<const Geometry> geometries(&geometry, 1);
  const PrimitiveReferences whole = make_references(geometries);
  // Cuts say when they are wanted no more; the guide itself ends at once.
  static std::atomic<bool> cancelled = false;
  static std::atomic<int> cuts = 0;
  cancelled = false;
  cuts = 0;
  const Clipper clipper{[](const void* data, const Reference& reference, uint32_t axis, float position) {
                          cancelled = ++cuts > 10;
                          return geometry_clipper(*static_cast<const std::span<const Geometry>*>(data))(reference, axis,
                                                                                                        position);
                        },
                        &geometries};
  WorkLimit limit;
  limit.cancelled = &cancelled;
  error_of(ErrorCode::stopped, [&] { split_automatically({geometries, whole.references, clipper, limit}, {16}); });
  EXPECT_LT(cuts, 100000) << "stopped long before the end";
}

TEST(AutomaticSplit, DoesNotDependOnThreads) {
  const Soup soup = needles_in_hay(4000, 40000, 8);
  const std::vector<Reference> one = [&] {
    std::vector<Reference> all;
    with_threads(1, [&] { all = split(soup).references; });
    return all;
  }();
  EXPECT_GT(one.size(), 44000U);
  for (const int threads : {2, 7}) {
    with_threads(threads, [&] { EXPECT_TRUE(same_bytes(one, split(soup).references)) << threads; });
  }
}

TEST(AutomaticSplit, DoesNotDependOnScaleOrAxes) {
  const Soup soup = needles_in_hay(1000, 20000, 9);
  const double r = share(split(soup), soup);
  for (const float scale : {1e-3F, 1e-6F, 1e3F, 1e6F, 1e-20F, 1e20F}) {
    EXPECT_NEAR(share(split(needles_in_hay(1000, 20000, 9, scale)), soup), r, 0.01 * r) << scale;
  }
  for (const uint32_t turn : {1U, 2U}) {
    EXPECT_NEAR(share(split(needles_in_hay(1000, 20000, 9, 1, turn)), soup), r, 0.01 * r) << turn;
  }
}

TEST(AutomaticSplit, TakesSpheresAndParallelograms) {
  Random random(10);
  std::vector<Sphere> spheres;
  std::vector<Parallelogram> shapes;
  for (int i = 0; i < 300; ++i) {
    spheres.push_back({10.0F * random.vector(), 3 * random.share()});
    shapes.push_back({10.0F * random.vector(), 8.0F * random.vector(), 0.1F * random.vector()});
  }
  Scene plain, cut;
  for (Scene* scene : {&plain, &cut}) {
    scene->add(Strided<Sphere>(spheres.data(), spheres.size()));
    scene->add(Strided<Parallelogram>(shapes.data(), shapes.size()));
  }
  plain.build({.structure = "brute_force"});
  cut.build({.structure = "early_split(auto)+binned_sah"});
  EXPECT_GT(cut.report().references, 700U);
  for (int i = 0; i < 5000; ++i) {
    const Ray ray{.origin = 12.0F * random.vector(), .direction = random.vector()};
    EXPECT_EQ(plain.closest_hit(ray), cut.closest_hit(ray)) << i;
  }
}

TEST(AutomaticSplit, GivesTheSameHitsForLess) {
  const Soup soup = needles_in_hay(800, 4000, 11);
  Scene brute, plain, cut;
  for (Scene* scene : {&brute, &plain, &cut}) scene->add(soup.mesh());
  brute.build({.structure = "brute_force"});
  plain.build({.structure = "binned_sah"});
  cut.build({.structure = "early_split(auto)+binned_sah"});
  Random random(12);
  TraceCounts before, after;
  for (int i = 0; i < 2000; ++i) {
    const Ray ray{.origin = 12.0F * random.vector(), .direction = random.vector()};
    const Hit hit = brute.closest_hit(ray);
    EXPECT_EQ(hit, plain.closest_hit(ray, before)) << i;
    EXPECT_EQ(hit, cut.closest_hit(ray, after)) << i;
  }
  EXPECT_LT(2 * (after.nodes + after.primitives), before.nodes + before.primitives);
}

TEST(AutomaticSplit, SurvivesExtremes) {
  for (const float scale : {1e-40F, 1e-30F, 1e28F}) {
    const Soup soup = needles_in_hay(200, 2000, 13, scale);
    EXPECT_LE(split(soup).references.size(), 4400U) << scale;
  }
  Soup flat = needles_in_hay(200, 2000, 14);
  for (Vec3f& v : flat.vertices) v.y = 3;
  EXPECT_LE(share(split(flat), flat), 2);
  for (Vec3f& v : flat.vertices) v.x = 3;
  EXPECT_TRUE(split(flat).references.empty()) << "no triangle has an area";
}

TEST(AutomaticSplit, DustDoesNotMakeTheRestBeCut) {
  // Where a sample finds nothing but dust, as in trees that can be refitted, what else lies there is not cut to dust.
  for (const float dust : {0.0F, 1e-6F}) {
    Random random(18);
    Soup soup;
    for (int i = 0; i < 300000; ++i) {
      const Vec3f at = 10.0F * random.vector();
      const float size = random.below(5) == 0 ? 0.1F : dust;
      soup.add(at, at + size * random.vector(), at + size * random.vector());
    }
    const Geometry geometry{soup.mesh()};
    const std::span<const Geometry> geometries(&geometry, 1);
    const PrimitiveReferences whole = make_references(geometries, false, true);
    const SplitResult result =
        split_automatically({geometries, whole.references, geometry_clipper(geometries), {}}, {});
    EXPECT_LE(static_cast<double>(result.references.size()), 1.03 * static_cast<double>(whole.references.size()))
        << dust << ": " << result.choice->reason;
  }
}

TEST(AutomaticSplit, LeavesPointsAlone) {
  Random random(19);
  Soup soup;
  for (int i = 0; i < 20000; ++i) {
    const Vec3f at = random.vector();
    soup.add(at, at, at);
  }
  const Geometry geometry{soup.mesh()};
  const std::span<const Geometry> geometries(&geometry, 1);
  const PrimitiveReferences whole = make_references(geometries, false, true);
  ASSERT_EQ(whole.references.size(), 20000U);
  const SplitResult result = split_automatically({geometries, whole.references, geometry_clipper(geometries), {}}, {});
  EXPECT_TRUE(same_bytes(result.references, whole.references));
  EXPECT_EQ(result.choice->reason.find("nan"), std::string::npos) << result.choice->reason;
}

TEST(AutomaticSplit, ExplainsItself) {
  const Soup soup = needles_in_hay(1000, 20000, 15);
  const SplitResult result = split(soup);
  const std::vector<SplitChoice::Step>& curve = result.choice->curve;
  ASSERT_GE(curve.size(), 3U);
  EXPECT_EQ(curve.front().references_per_primitive, 1);
  EXPECT_NEAR(curve.back().references_per_primitive, share(result, soup), 1e-9);
  for (size_t i = 1; i < curve.size(); ++i) {
    EXPECT_GE(curve[i].references_per_primitive, curve[i - 1].references_per_primitive);
    EXPECT_LT(curve[i].cost, curve[i - 1].cost);
  }
  EXPECT_NE(result.choice->reason.find("predicted cost"), std::string::npos);
  EXPECT_NE(split(soup, {1.05}).choice->reason.find("the cap of 1.05"), std::string::npos);
}

TEST(AutomaticSplit, IsAWordOfThePipeline) {
  EXPECT_EQ(parse_pipeline("early_split(auto)+binned_sah").text(), "early_split(sa_max=auto)+binned_sah");
  EXPECT_EQ(parse_pipeline("early_split( sa_max = auto , cap=1.5)+binned_sah").text(),
            "early_split(sa_max=auto,cap=1.5)+binned_sah");
  for (const char* wrong : {"early_split(auto,sa_max=3)+binned_sah", "early_split(sa_max=automatic)+binned_sah",
                            "early_split(cap=auto)+binned_sah", "early_split(auto,budget=2)+binned_sah",
                            "refine(auto)+binned_sah", "binned_sah(auto)"}) {
    error_of(ErrorCode::invalid_option, [&] {
      parse_pipeline(wrong);
      Scene().build({.structure = wrong});
    });
  }
  const Soup soup = needles_in_hay(300, 3000, 16);
  Scene scene;
  scene.add(soup.mesh());
  const BuildReport& report = scene.build({.structure = "early_split(auto,cap=1.1)+binned_sah"});
  EXPECT_LE(report.references_per_primitive, 1.1);
  EXPECT_TRUE(report.capped);
  EXPECT_TRUE(is_automatic(report.sa_max));
  EXPECT_FALSE(report.choice->reason.empty());
  EXPECT_FALSE(scene.build({.structure = "binned_sah"}).choice.has_value());
}

TEST(AutomaticSplit, FeedsOtherBuilders) {
  Soup soup = needles_in_hay(300, 3000, 17);
  EXPECT_TRUE(same_bytes(split_references(soup.mesh(), AutomaticSplit{}), split(soup).references));
  soup.vertices[7].y = std::nanf("");
  error_of(ErrorCode::invalid_geometry, [&] { split_references(soup.mesh(), AutomaticSplit{}); });
  EXPECT_GT(split_references(soup.mesh(), AutomaticSplit{}, true).size(), 3299U);
}

}  // namespace
}  // namespace kerf::test
