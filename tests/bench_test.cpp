// Measuring Kerf beside Embree: every way to feed rays finds the same, limits and interrupts keep what is measured.

#include "kerf/study/bench.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "kerf/base/error.h"
#include "kerf/base/parallel.h"
#include "kerf/render/render_scene.h"
#include "kerf/study/embree_builder.h"
#include "kerf/study/embree_text.h"
#include "kerf/study/hit_verdict.h"
#include "kerf/study/ray_order.h"
#include "tests/support/random_study.h"

namespace kerf::test {
namespace {

/// A number of rays that fills no packet.
BenchOptions quick() {
  BenchOptions options;
  options.rows = {"binned_sah", "early_split(budget=1.5)+binned_sah+skip_pointer"};
  options.width = 43;
  options.height = 29;
  options.repeat = 3;
  options.threads = 1;
  return options;
}

void expect_right_hits(const StudyScene& scene, const BenchScene& result, const BenchOptions& options) {
  const Scene brute = build_scene(scene.description, {.structure = "brute_force"});
  const std::vector<StudyRays> rays =
      make_study_rays(scene.description, scene.camera, options.width, options.height, options.kinds);
  for (size_t kind = 0; kind < rays.size(); ++kind) {
    size_t hits = 0;
    for (const Ray& ray : rays[kind].rays) {
      hits += (rays[kind].any_hit ? brute.any_hit(ray) : static_cast<bool>(brute.closest_hit(ray))) ? 1 : 0;
    }
    EXPECT_EQ(result.ray_counts[kind], rays[kind].rays.size());
    for (const BenchRow& row : result.rows) {
      ASSERT_TRUE(row.finished) << row.name() << ": " << row.why_not;
      for (const BenchRun& run : row.runs) {
        if (run.kind != kind) continue;
        const std::string what = row.name() + " " + std::string(feed_entry(run.feed).name) + " " + rays[kind].kind;
        if (row.engine == BenchEngine::kerf) {
          EXPECT_EQ(run.hits, hits) << what;
          EXPECT_EQ(run.unlike_kerf, 0U) << what;
        } else {
          EXPECT_NEAR(static_cast<double>(run.hits), static_cast<double>(hits), 5) << what;
          EXPECT_FALSE(run.unlike_kerf) << what;
        }
        if (run.unlike_robust) {
          EXPECT_LE(*run.unlike_robust, 10U) << what;
        }
        EXPECT_EQ(run.seconds.size(), static_cast<size_t>(options.repeat)) << what;
      }
    }
  }
}

TEST(Bench, EveryFeedFindsTheSame) {
  const StudyScene scene = random_study(1000);
  for (const int threads : {1, std::min(2, thread_count())}) {
    BenchOptions options = quick();
    options.threads = threads;
    const BenchScene result = bench(scene, "straight", options);
    EXPECT_EQ(result.threads, threads);
    EXPECT_EQ(result.triangles, 1000U);
    EXPECT_EQ(result.rows.size(), has_embree() ? 6U : 2U);
    EXPECT_EQ(result.rows[0].runs.size(), 6U) << "loop and batch, of three kinds of rays";
    EXPECT_EQ(result.rows[0].name(), "kerf binned_sah bvh2");
    EXPECT_EQ(result.rows[1].layout, "skip_pointer");
    EXPECT_EQ(result.rows[0].isa, "scalar");
    EXPECT_NEAR(*result.rows[1].references, 1500, 15);
    expect_right_hits(scene, result, options);
    for (const BenchVerdicts& verdicts : result.verdicts) {
      EXPECT_EQ(verdicts.counts[static_cast<size_t>(Verdict::unexplained)], 0U);
      EXPECT_EQ(verdicts.not_judged, 0U);
      EXPECT_GT(verdicts.counts[0], 0U);
    }
    EXPECT_EQ(result.verdicts.size(), has_embree() ? 3U : 0U);
  }
}

TEST(Bench, WhatEmbreeSaysOfItself) {
  if (!has_embree()) GTEST_SKIP() << "Embree was not found";
  const BenchScene result = bench(random_study(1000), "straight", quick());
  for (const char* words : {"Embree ", "hugepages=1", "FTZ", "threads=1"}) {
    EXPECT_NE(result.rival.find(words), std::string::npos) << result.rival;
  }
  const BenchRow *high = result.embree("high"), *robust = result.embree("robust");
  ASSERT_TRUE(high != nullptr && robust != nullptr && result.embree("medium") != nullptr);
  EXPECT_NE(high->builder.find("Spatial"), std::string::npos) << high->builder;
  EXPECT_EQ(robust->builder.find("Spatial"), std::string::npos) << "the robust scene gives up spatial splits";
  EXPECT_NE(high->layout.find("BVH"), std::string::npos);
  EXPECT_NE(high->isa, "");
  EXPECT_GT(high->bytes, 1000 * 40U);
  EXPECT_LT(high->bytes, 1000 * 200U);
  ASSERT_TRUE(high->references && robust->references);
  EXPECT_NEAR(*robust->references, 1000, 5);
  EXPECT_GE(*high->references, 995);
  EXPECT_NE(high->run(0, Feed::sorted), nullptr);
  EXPECT_EQ(robust->run(0, Feed::sorted), nullptr);
}

TEST(Bench, TakesSpheresParallelogramsAndAnEmptyScene) {
  StudyScene scene = random_study(1000);
  scene.description.objects.push_back({Sphere{{0, 0, 12}, 3}, 0, true, ""});
  scene.description.objects.push_back({Parallelogram{{-9, -9, 11}, {4, 0, 0}, {0, 4, 1}}, 0, true, ""});
  scene.description.objects.push_back({Sphere{{6, 6, 13}, 2}, 0, false, "hidden from the camera"});
  expect_right_hits(scene, bench(scene, "straight", quick()), quick());
  scene.description.objects.clear();
  const BenchScene empty = bench(scene, "x", quick());
  EXPECT_EQ(empty.title(), "random turned x");
  for (const BenchRow& row : empty.rows) {
    EXPECT_TRUE(row.finished) << row.name() << ": " << row.why_not;
    EXPECT_EQ(row.run(0, Feed::loop)->hits, 0U);
  }
}

TEST(Bench, LimitsGiveRowsUp) {
  BenchOptions options = quick();
  options.limit_bytes = 1000;
  for (const BenchRow& row : bench(random_study(1000), "straight", options).rows) {
    EXPECT_FALSE(row.finished) << row.name();
    EXPECT_NE(row.why_not, "it was interrupted") << row.name();
    EXPECT_TRUE(row.runs.empty());
  }
  options = quick();
  options.rows = {"no_such_builder"};
  EXPECT_THROW(bench(random_study(1000), "straight", options), Error);
}

TEST(Bench, AnInterruptKeepsWhatIsMeasured) {
  BenchOptions options = quick();
  options.repeat = 1000;
  std::atomic<bool> cancelled = false;
  options.cancelled = &cancelled;
  int traced = 0;
  double last = 0;
  options.progress = [&](double done, std::string_view what) {
    EXPECT_GE(done, last);
    EXPECT_LE(done, 1);
    last = done;
    traced += what.find(": trace ") != std::string_view::npos ? 1 : 0;
    if (traced == 20) cancelled = true;
    return !cancelled;
  };
  const BenchScene result = bench(random_study(1000), "straight", options);
  ASSERT_TRUE(result.rows[0].finished) << result.rows[0].why_not;
  EXPECT_GE(result.rows[0].runs[0].seconds.size(), 1U);
  EXPECT_LT(result.rows[0].runs[0].seconds.size(), 30U);

  cancelled = false;
  traced = 0;
  options.progress = [&](double, std::string_view what) {
    cancelled = what.find(": compare ") != std::string_view::npos;
    return !cancelled;
  };
  for (const BenchRow& row : bench(random_study(1000), "straight", options).rows) {
    EXPECT_FALSE(row.finished);
    EXPECT_EQ(row.why_not, "it was interrupted");
  }
}

TEST(BenchRows, AreThePresetsAndWideLayouts) {
  const std::vector<std::string> rows = bench_rows();
  EXPECT_NE(std::find(rows.begin(), rows.end(), "best"), rows.end());
  for (const std::string& row : rows) EXPECT_NO_THROW(build_scene({}, {.structure = row})) << row;
}

TEST(RayOrder, PutsWhatGoesAlikeTogether) {
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<Ray> rays;
  for (int i = 0; i < 64; ++i) {
    Ray ray;
    ray.origin = {static_cast<float>(i % 2) * 100, i < 32 ? 0.0F : 1.0F, 0};
    ray.direction = {i % 4 < 2 ? 1.0F : -1.0F, 0.5F, 0.25F};
    rays.push_back(ray);
  }
  rays.push_back({.origin = {nan, inf, 0}, .direction = {nan, -inf, 0}});
  const std::vector<uint32_t> order = ray_order(rays);
  std::vector<uint32_t> sorted = order;
  std::sort(sorted.begin(), sorted.end());
  for (uint32_t i = 0; i < rays.size(); ++i) EXPECT_EQ(sorted[i], i) << "each once";
  const std::vector<uint32_t> finite = ray_order(std::span(rays).first(64));
  int changes = 0;
  for (size_t i = 1; i < finite.size(); ++i) {
    const Ray &a = rays[finite[i - 1]], &b = rays[finite[i]];
    const bool is_alike = a.origin == b.origin && a.direction == b.direction;
    changes += is_alike ? 0 : 1;
    if (is_alike) {
      EXPECT_LT(finite[i - 1], finite[i]) << "equal ones stay in order";
    }
  }
  EXPECT_EQ(changes, 7) << "two directions of two columns, each in two halves: eight kinds of rays";
  EXPECT_TRUE(ray_order({}).empty());
}

TEST(EmbreeText, IsReadForItsFigures) {
  const EmbreeText text = parse_embree_text(
      "Embree Ray Tracing Kernels 4.3.0 (abc)\n  hugepages          = disabled\n"
      "building BVH8<triangle4v> using avx2::BVH8BuilderX ...\n"
      "  leaves           : sah = 2 ( 90.00%), #bytes = 0.09 MB ( 90.00%), #nodes =      10 ( 50.00% filled), #b = 4\n"
      "    histogram      :  60.00%  40.00%   0.00% \n"
      "building BVH4<object> using sse2::BVH4BuilderY ...\n"
      "  leaves           : sah = 2 ( 90.00%), #bytes = 0.09 MB ( 90.00%), #nodes =       3 (100.00% filled), #b = 4\n"
      "    histogram      :  100.00%  0.00% \n"
      "selected scene intersector\n  intersector1  = avx2::BVH8Whatever\n");
  EXPECT_EQ(text.version, "4.3.0");
  EXPECT_EQ(text.hugepages, "disabled");
  EXPECT_EQ(text.builder, "avx2::BVH8BuilderX, sse2::BVH4BuilderY");
  EXPECT_EQ(text.layout, "BVH8<triangle4v>, BVH4<object>");
  EXPECT_EQ(text.isa, "avx2");
  ASSERT_TRUE(text.references);
  EXPECT_NEAR(*text.references, 10 * 1.4 * 4 * 0.5 + 3, 1e-9);
  const EmbreeText nothing = parse_embree_text("something else\n");
  EXPECT_EQ(nothing.version + nothing.builder + nothing.isa, "");
  EXPECT_FALSE(nothing.references);
}

TEST(HitVerdict, KnowsWhereARayBegins) {
  std::vector<SceneObject> objects(2);
  Mesh mesh;
  mesh.vertices = {{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}};
  mesh.triangles = {{0, 1, 2}};
  objects[0].shape = mesh;
  objects[1].shape = Sphere{{0, 0, 5}, 1};
  const Ray leaving{.origin = {0, 0, 1e-6F}, .direction = {0, 0, 1}};
  const Hit on_triangle{0, 0, 0, 0, 0, kNone}, on_sphere{4, 0, 0, 0, 1, kNone};
  EXPECT_EQ(judge(objects, leaving, {}, {}), Verdict::same);
  EXPECT_EQ(judge(objects, leaving, {}, on_triangle), Verdict::oracle_wrong) << "the triangle lies behind the origin";
  const Ray reaching{.origin = {0, 0, 1}, .direction = {0, 0, -1}};
  EXPECT_EQ(judge(objects, reaching, {}, {1, 0, 0, 0, 0, kNone}), Verdict::unexplained);
  EXPECT_EQ(judge(objects, reaching, {1, 0, 0, 0, 0, kNone}, {}), Verdict::oracle_wrong);
  EXPECT_EQ(judge(objects, leaving, on_sphere, on_sphere), Verdict::same);
  EXPECT_EQ(judge(objects, leaving, on_sphere, {}), std::nullopt) << "no triangle";
}

}  // namespace
}  // namespace kerf::test
