// What Kerf beside Embree is held to, judged on made results: reached, missed, and not known; the table of them.

#include "kerf/study/bench_goals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "kerf/study/bench_ratios.h"
#include "kerf/study/bench_tables.h"
#include "tests/support/bench_sample.h"

namespace kerf::test {
namespace {

constexpr BenchEngine kKerf = BenchEngine::kerf, kEmbree = BenchEngine::embree;

using Scenes = std::vector<BenchScene>;

BenchVerdict judged(const Scenes& scenes, std::string_view id) {
  for (const BenchVerdict& verdict : bench_verdicts(scenes)) {
    if (verdict.goal->id == id) return verdict;
  }
  ADD_FAILURE() << "no goal " << id;
  return {};
}

void set_seconds(BenchRow& row, Feed feed, double seconds) {
  for (BenchRun& run : row.runs) {
    if (run.feed == feed) run.seconds.assign(3, seconds);
  }
}

/// With one thread, and with two that halve everything.
Scenes with_two_threads() {
  Scenes scenes{made_bench_scene(), made_bench_scene()};
  scenes[1].threads = 2;
  for (BenchRow& row : scenes[1].rows) {
    for (double& seconds : row.builds) seconds /= 2;
    for (BenchRun& run : row.runs) {
      for (double& seconds : run.seconds) seconds /= 2;
    }
  }
  return scenes;
}

/// One family's smallest and largest model.
Scenes family(uint64_t most, double slowdown) {
  Scenes scenes{made_bench_scene("plant 10000"), made_bench_scene("plant")};
  for (BenchScene& scene : scenes) scene.family = "plant";
  scenes[0].triangles = 10000;
  scenes[1].triangles = most;
  for (BenchRow& row : scenes[1].rows) set_seconds(row, Feed::loop, row.engine == kKerf ? 2 * slowdown : 3);
  set_seconds(bench_row_of(scenes[1], kEmbree, "high"), Feed::loop, 3);
  return scenes;
}

TEST(BenchResult, RatiosAreMediansOfPairs) {
  BenchRun base{0, Feed::loop, 0, {}, {}, {1, 10, 3}}, run{0, Feed::loop, 0, {}, {}, {1, 5, 1}};
  EXPECT_EQ(speed_ratio(&base, &run), 2) << "of 1, 2 and 3";
  run.seconds.pop_back();
  EXPECT_EQ(speed_ratio(&base, &run), 1.5) << "what has no partner is left out";
  EXPECT_TRUE(std::isnan(speed_ratio(nullptr, &run)));
  const BenchScene scene = made_bench_scene();
  EXPECT_EQ(scene.mrays(scene.rows[0].runs[0]), 1 / 0.7);
  EXPECT_EQ(build_seconds(&scene.rows[0]), 0.9) << "the median";
}

TEST(BenchRatios, AreGeometricMeansOverScenes) {
  Scenes scenes{made_bench_scene("a"), made_bench_scene("b")};
  set_seconds(bench_row_of(scenes[0], kKerf, "best"), Feed::loop, 0.25);
  set_seconds(bench_row_of(scenes[1], kKerf, "best"), Feed::loop, 1);
  EXPECT_DOUBLE_EQ(mean_ratio(scenes, "kerf best bvh8", Feed::loop, "diffuse"), 2);
  EXPECT_TRUE(std::isnan(mean_ratio(scenes, "kerf best bvh8", Feed::loop, "loaded")));
  EXPECT_EQ(judged_row(scenes, Feed::loop), "kerf best bvh8");
  set_seconds(bench_row_of(scenes[0], kKerf, "best"), Feed::loop, 1);
  EXPECT_EQ(judged_row(scenes, Feed::loop), "kerf best quantised_bvh8")
      << "one row for all scenes, whose mean is greatest";
  bench_row_of(scenes[1], kKerf, "best").finished = false;
  EXPECT_TRUE(std::isnan(mean_ratio(scenes, "kerf best bvh8", Feed::loop, "diffuse")));
}

TEST(BenchGoals, ASceneThatReachesAllThatItCan) {
  for (const BenchVerdict& verdict : bench_verdicts(Scenes{made_bench_scene()})) {
    const std::string_view id = verdict.goal->id;
    const bool is_possible = !id.starts_with("threads") && id != "growth" && id != "watertight";
    EXPECT_EQ(verdict.state, is_possible ? GoalState::reached : GoalState::not_measured) << id << ": " << verdict.text;
    EXPECT_NE(verdict.text, "") << id;
  }
  EXPECT_DOUBLE_EQ(judged({made_bench_scene()}, "batch_best").measured, 1.4) << "beside streams, its fastest way";
  EXPECT_NEAR(judged({made_bench_scene()}, "build_best").measured, 0.9, 1e-12);
}

TEST(BenchGoals, ThreadsAndGrowth) {
  EXPECT_EQ(judged(with_two_threads(), "threads_rays").state, GoalState::reached);
  EXPECT_EQ(judged(with_two_threads(), "threads_builds").state, GoalState::reached);
  Scenes scenes = with_two_threads();
  set_seconds(bench_row_of(scenes[1], kKerf, "best"), Feed::loop, 0.4);
  set_seconds(scenes[1].rows[3], Feed::loop, 0.4);
  EXPECT_EQ(judged(scenes, "threads_rays").state, GoalState::missed);
  bench_row_of(scenes[1], kKerf, "balanced").builds.assign(3, 0.35 / 1.9);
  EXPECT_EQ(judged(scenes, "threads_builds").state, GoalState::missed);
  EXPECT_EQ(judged(scenes, "single_diffuse").state, GoalState::reached) << "only one thread counts there";

  EXPECT_EQ(judged(family(10000000, 1), "growth").state, GoalState::reached);
  EXPECT_EQ(judged(family(10000000, 1.2), "growth").state, GoalState::missed);
  EXPECT_EQ(judged(family(1000000, 1), "growth").state, GoalState::not_measured) << "not far enough";
  EXPECT_EQ(judged(family(1000000, 1.2), "growth").state, GoalState::missed);
  EXPECT_EQ(judged(family(10000000, 1), "single_diffuse").state, GoalState::not_measured) << "no scene but models";
}

struct Fault {
  const char* goal;  // that it must miss
  std::function<void(BenchScene&)> plant;
};

const Fault kFaults[] = {
    {"single_diffuse",
     [](auto& s) {
       for (auto& row : s.rows)
         if (row.engine == kKerf) row.runs[1].seconds.assign(3, 0.81);
     }},
    {"single_shadow",
     [](auto& s) {
       for (auto& row : s.rows)
         if (row.engine == kKerf) row.runs[2].seconds.assign(3, 0.81);
     }},
    {"single_primary",
     [](auto& s) {
       for (auto& row : s.rows)
         if (row.engine == kKerf) row.runs[0].seconds.assign(3, 0.81);
     }},
    {"single_least",
     [](auto& s) {
       for (auto& row : s.rows)
         if (row.engine == kKerf) row.runs[1].seconds.assign(3, 1.12);
     }},
    {"robust", [](auto& s) { set_seconds(bench_row_of(s, kEmbree, "robust"), Feed::loop, 1.39); }},
    {"batch_diffuse", [](auto& s) { set_seconds(bench_row_of(s, kKerf, "best"), Feed::batch, 0.58); }},
    {"batch_shadow", [](auto& s) { set_seconds(bench_row_of(s, kKerf, "best"), Feed::batch, 0.58); }},
    {"batch_best", [](auto& s) { set_seconds(bench_row_of(s, kEmbree, "high"), Feed::stream, 0.62); }},
    {"build_balanced", [](auto& s) { bench_row_of(s, kKerf, "balanced").builds.assign(3, 0.361); }},
    {"build_balanced", [](auto& s) { set_seconds(bench_row_of(s, kKerf, "balanced"), Feed::loop, 1.06); }},
    {"build_best", [](auto& s) { bench_row_of(s, kKerf, "best").builds.assign(3, 1.01); }},
    {"build_fast", [](auto& s) { bench_row_of(s, kKerf, "fast").builds.assign(3, 0.2); }},
    {"bytes", [](auto& s) { bench_row_of(s, kKerf, "best").bytes = 121000; }},
    {"bytes_quantised", [](auto& s) { s.rows[3].bytes = 61000; }},
    {"bytes_quantised", [](auto& s) { s.rows[3].runs[0].seconds.assign(3, 2); }},
    {"hits", [](auto& s) { s.verdicts[1].counts[4] = 1; }},
    {"hits", [](auto& s) { s.rows[1].runs[0].unlike_kerf = 1; }},
};

TEST(BenchGoals, EachFaultMissesItsGoal) {
  for (const Fault& fault : kFaults) {
    BenchScene scene = made_bench_scene();
    fault.plant(scene);
    const BenchVerdict verdict = judged({scene}, fault.goal);
    EXPECT_EQ(verdict.state, GoalState::missed) << fault.goal << ": " << verdict.text;
  }
}

TEST(BenchGoals, WhatIsNotKnownIsNotReached) {
  for (const BenchVerdict& verdict : bench_verdicts(Scenes{})) EXPECT_EQ(verdict.state, GoalState::not_measured);
  Scenes scenes{made_bench_scene("a"), made_bench_scene("b")};
  scenes[1].rows.clear();
  scenes[1].verdicts.clear();
  for (const BenchVerdict& verdict : bench_verdicts(scenes)) {
    if (verdict.goal->id == "hits") continue;
    EXPECT_EQ(verdict.state, GoalState::not_measured) << verdict.goal->id << ": " << verdict.text;
  }
  EXPECT_NE(judged(scenes, "single_diffuse").text.find("not known on 1 of 2 scenes"), std::string::npos);
  scenes[1] = made_bench_scene("b");
  scenes[1].ray_counts[1] = 0;
  EXPECT_EQ(judged(scenes, "single_diffuse").state, GoalState::not_measured) << "no rays of that kind";
  scenes[1].ray_counts[1] = 1000000;
  scenes[1].threads = 2;
  EXPECT_EQ(judged(scenes, "single_diffuse").state, GoalState::reached);
  EXPECT_EQ(judged(scenes, "threads_rays").state, GoalState::not_measured) << "another scene";
}

TEST(BenchText, HasEveryRowTheMeansAndTheGoals) {
  Scenes scenes{made_bench_scene("a"), made_bench_scene("b")};
  scenes[0].rows[2].finished = false;
  scenes[0].rows[2].why_not = "it took too long";
  const std::string text = bench_text(scenes);
  for (const char* words : {"a: 1000 triangles; 1 thread; rays: 1000000 primary", "best bvh8 ", "Embree HIGH",
                            "not finished: it took too long", "1.429 +-0 % 1.43x", "geometric means over 2 scenes",
                            "1.429x", "single rays, diffuse", "0 unexplained", "high_builder, BVH8<triangle4>"}) {
    EXPECT_NE(text.find(words), std::string::npos) << words << "\n" << text;
  }
  for (const BenchGoal& goal : bench_goals()) EXPECT_NE(text.find(goal.bar), std::string::npos) << goal.id;
  EXPECT_EQ(text.find("UNLIKE"), std::string::npos);
  scenes[0].rows[1].runs[0].unlike_kerf = 3;
  EXPECT_NE(bench_text(scenes).find("3 UNLIKE THE FIRST ROW"), std::string::npos);
  EXPECT_EQ(bench_text({}), "");
  scenes[0].rival = scenes[1].rival = "";
  EXPECT_EQ(bench_text(scenes).find("goals"), std::string::npos) << "nothing to judge without a rival";
}

}  // namespace
}  // namespace kerf::test
