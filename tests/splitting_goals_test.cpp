// What splitting is held to, judged on made results: reached, missed, and not known.

#include "kerf/study/splitting_goals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "kerf/study/splitting_tables.h"
#include "kerf/study/spread.h"
#include "tests/support/splitting_sample.h"

namespace kerf::test {
namespace {

using Role = SplittingRole;

const GoalVerdict& verdict_of(const std::vector<GoalVerdict>& verdicts, std::string_view id) {
  for (const GoalVerdict& verdict : verdicts) {
    if (verdict.goal->id == id) return verdict;
  }
  static const GoalVerdict none;
  ADD_FAILURE() << "no goal " << id;
  return none;
}

GoalVerdict judged(const SplittingScene& scene, std::string_view id) { return verdict_of(scene_verdicts(scene), id); }

TEST(Spread, TheRanksOfAMediansIntervalAreThoseOfTheBinomial) {
  // Of 15 throws at most 3 are heads with a chance of (1 + 15 + 105 + 455) / 32768 = 0.0176; at most 4: 0.0592.
  EXPECT_EQ(median_rank(15), 4);
  EXPECT_EQ(median_rank(6), 1) << "2 / 64 = 0.031 lie outside";
  EXPECT_EQ(median_rank(5), std::nullopt) << "2 / 32 = 0.0625 lie outside";
  EXPECT_EQ(median_rank(0), std::nullopt);
  EXPECT_EQ(median_rank(9), 2);
  EXPECT_EQ(median_rank(25), 8);
  std::vector<double> values;
  for (int i = 15; i >= 1; --i) values.push_back(i);
  const auto interval = median_interval(values);
  ASSERT_TRUE(interval);
  EXPECT_EQ(interval->lower, 4);
  EXPECT_EQ(interval->upper, 12);
  EXPECT_FALSE(median_interval({1, 2, 3, 4, 5}));
}

TEST(Spread, MeansAndMedians) {
  EXPECT_EQ(median_of({3, 1, 2}), 2);
  EXPECT_EQ(median_of({4, 1, 2, 3}), 2.5);
  EXPECT_TRUE(std::isnan(median_of({})));
  EXPECT_DOUBLE_EQ(geometric_mean(std::vector<double>{1, 4}), 2);
  EXPECT_TRUE(std::isnan(geometric_mean(std::vector<double>{1, 0})));
  EXPECT_TRUE(std::isnan(geometric_mean({})));
}

TEST(SplittingResult, SharesAndSpeedsAreOfPairs) {
  SplittingScene scene = made_splitting_scene();
  const SplittingRow& automatic = *scene.row(Role::automatic);
  EXPECT_DOUBLE_EQ(visits_share(scene, automatic), 0.5);
  row_of(scene, Role::automatic).rays[0].nodes = 35;  // and 5 triangles: 40
  EXPECT_DOUBLE_EQ(visits_share(scene, automatic, 0), 1);
  EXPECT_DOUBLE_EQ(visits_share(scene, automatic), std::sqrt(0.5)) << "the geometric mean of 1 and 0.5";
  scene.ray_counts[0] = 0;
  EXPECT_DOUBLE_EQ(visits_share(scene, automatic), 0.5) << "kinds without rays say nothing";
  const std::vector<double> speeds = paired_speeds(scene, *scene.row(Role::plain), automatic);
  EXPECT_EQ(speeds, std::vector<double>(15, 2));
  EXPECT_DOUBLE_EQ(splitting_cost(*scene.row(Role::plain), automatic), 0.2);
  EXPECT_EQ(best_of_sweep(scene)->budget, 2);
}

TEST(SplittingGoals, ASceneThatReachesThemAll) {
  for (const GoalVerdict& verdict : scene_verdicts(made_splitting_scene())) {
    const std::string_view id = verdict.goal->id;
    const bool is_asked = id != "meshes" && id != "win" && id != "best" && id != "reinsertion";
    EXPECT_EQ(verdict.state, is_asked ? GoalState::reached : GoalState::not_asked) << id << ": " << verdict.text;
    EXPECT_NE(verdict.text, "") << id;
  }
  const SplittingScene scene = made_splitting_scene();
  EXPECT_NEAR(judged(scene, "gain").measured, 0.5 / (1 - 19 / 40.0), 1e-12);
  EXPECT_NEAR(judged(scene, "sbvh_speed").measured, 0.96, 1e-12);
  EXPECT_NEAR(judged(scene, "sbvh_build").measured, 0.3, 1e-12);
  EXPECT_NEAR(judged(scene, "follows").measured, 0.001 / 1.3, 1e-12);
}

struct Fault {
  const char* goal;  // that it must miss
  std::function<void(SplittingScene&)> plant;
};

void set_visits(SplittingScene& scene, Role role, double visits) {
  for (SplittingRow::Rays& rays : row_of(scene, role).rays) rays = {visits, 0, rays.hits, rays.seconds};
}

void set_seconds(SplittingScene& scene, Role role, double seconds) {
  for (SplittingRow::Rays& rays : row_of(scene, role).rays) rays.seconds.assign(15, seconds);
}

const Fault kFaults[] = {
    {"counts", [](auto& s) { row_of(s, Role::automatic).rays[1].nodes = 36; }},  // 41 instead of 40 in one kind
    {"times", [](auto& s) { row_of(s, Role::automatic).rays[1].seconds.assign(15, 2.03); }},
    {"meshes", [](auto& s) { s.name = "bunny"; }},
    {"win",
     [](auto& s) {
       s.name = "sponza";
       s.turn = "xyz";
     }},
    {"win",
     [](auto& s) {  // fast enough with too many references
       s.name = "plant_3";
       set_seconds(s, Role::automatic, 0.5);
       row_of(s, Role::automatic).references_per_primitive = 1.6;
     }},
    {"gain", [](auto& s) { set_visits(s, Role::spatial_split, 15); }},
    {"near_best", [](auto& s) { set_visits(s, Role::automatic, 21.1); }},
    {"sbvh_speed", [](auto& s) { set_seconds(s, Role::spatial_split, 0.84); }},
    {"sbvh_build",
     [](auto& s) {
       row_of(s, Role::balanced).builds.assign(3, {0, 0, 0, 0, 0, 1.4});
     }},
    {"embree", [](auto& s) { set_visits(s, Role::embree_high, 18); }},
    {"cost",
     [](auto& s) {
       row_of(s, Role::automatic).builds.assign(3, {0, 0.26, 0, 0, 0, 1.4});
     }},
    {"follows", [](auto& s) { s.variants[2].references_per_primitive = 1.32; }},
    {"trees", [](auto& s) { s.trees[1].hashes[2] = 8; }},
    {"hits", [](auto& s) { row_of(s, Role::budget, 1.5).rays[1].hits = 49; }},
    {"cap", [](auto& s) { s.capped_references = 1.2001; }},
    {"peak", [](auto& s) { row_of(s, Role::balanced).peak_bytes = 2501; }},
    {"refusal", [](auto& s) { s.refusal->is_refused = false; }},
};

TEST(SplittingGoals, EachIsMissedWhereItsBarIs) {
  for (const Fault& fault : kFaults) {
    SplittingScene scene = made_splitting_scene();
    fault.plant(scene);
    const GoalVerdict verdict = judged(scene, fault.goal);
    EXPECT_EQ(verdict.state, GoalState::missed) << fault.goal << ": " << verdict.text;
    EXPECT_LT(verdict.slack, 0) << fault.goal;
    const std::vector<SplittingScene> both{made_splitting_scene(), scene};
    EXPECT_EQ(verdict_of(overall_verdicts(both), fault.goal).state, GoalState::missed) << "one scene is enough";
    EXPECT_NE(splitting_text(both).find("missed"), std::string::npos);
  }
}

TEST(SplittingGoals, WhatIsNotKnownIsNotReached) {
  for (const Role role : {Role::plain, Role::automatic, Role::balanced, Role::spatial_split}) {
    SplittingScene scene = made_splitting_scene();
    SplittingRow& row = row_of(scene, role);
    row = {};
    row.role = role;
    size_t unknown = 0;
    for (const GoalVerdict& verdict : scene_verdicts(scene)) {
      unknown += verdict.state == GoalState::not_measured ? 1 : 0;
      EXPECT_NE(verdict.state, GoalState::missed) << verdict.goal->id << ": " << verdict.text;
    }
    EXPECT_GE(unknown, 2U);
  }
  const SplittingScene nothing;
  for (const GoalVerdict& verdict : scene_verdicts(nothing)) {
    EXPECT_EQ(verdict.state, GoalState::not_measured) << verdict.goal->id;
  }
  for (const GoalVerdict& verdict : overall_verdicts({&nothing, 1})) {
    EXPECT_NE(verdict.state, GoalState::reached) << verdict.goal->id;
  }
}

TEST(SplittingGoals, FewRunsAndPartsOfChecksAreNotEnough) {
  SplittingScene scene = made_splitting_scene();
  for (SplittingRow& row : scene.rows) {
    for (SplittingRow::Rays& rays : row.rays) rays.seconds.resize(std::min<size_t>(rays.seconds.size(), 5));
  }
  EXPECT_EQ(judged(scene, "times").state, GoalState::not_measured);
  scene.variants.pop_back();
  EXPECT_EQ(judged(scene, "follows").state, GoalState::not_measured);
  scene.trees.pop_back();
  EXPECT_EQ(judged(scene, "trees").state, GoalState::not_measured);
  row_of(scene, Role::balanced).peak_bytes.reset();
  EXPECT_EQ(judged(scene, "peak").state, GoalState::not_measured);
}

TEST(SplittingGoals, AnIntervalAroundTheBarIsOpenNotMissed) {
  SplittingScene scene = made_splitting_scene();
  std::vector<double>& seconds = row_of(scene, Role::automatic).rays[0].seconds;
  for (size_t i = 0; i < seconds.size(); ++i) seconds[i] = 2 + 0.02 * (static_cast<double>(i) - 7);
  const GoalVerdict verdict = judged(scene, "times");
  EXPECT_EQ(verdict.state, GoalState::reached);
  EXPECT_NEAR(verdict.measured, 2 / 1.92, 1e-12) << "the 12th of the speeds is the 4th of the times";
  EXPECT_NE(verdict.text.find("not excluded"), std::string::npos) << verdict.text;
}

TEST(SplittingGoals, SmallScenesAndScenesWithNothingToFindAreNotAsked) {
  SplittingScene scene = made_splitting_scene();
  scene.triangles = 100000;
  row_of(scene, Role::automatic).builds.assign(3, {0, 0.9, 0, 0, 0, 1.4});
  EXPECT_EQ(judged(scene, "cost").state, GoalState::not_asked);
  for (SplittingRow& row : scene.rows) {
    for (SplittingRow::Rays& rays : row.rays) rays = {39.9, 0, 50, rays.seconds};
  }
  EXPECT_EQ(judged(scene, "gain").state, GoalState::not_asked);
}

TEST(SplittingGoals, MeansAreGeometricAndHeldToTheirBars) {
  std::vector<SplittingScene> scenes(2, made_splitting_scene());
  const GoalVerdict good = verdict_of(overall_verdicts(scenes), "best");
  EXPECT_EQ(good.state, GoalState::reached);
  EXPECT_NEAR(good.measured, 15 / 19.0, 1e-12);
  set_visits(scenes[1], Role::best, 18);
  const GoalVerdict bad = verdict_of(overall_verdicts(scenes), "best");
  EXPECT_EQ(bad.state, GoalState::missed);
  EXPECT_NEAR(bad.measured, std::sqrt(15 * 18) / 19, 1e-12);
  // Above 0.85 everywhere, but 0.9 on average.
  for (SplittingScene& scene : scenes) set_seconds(scene, Role::spatial_split, 0.9);
  EXPECT_EQ(judged(scenes[0], "sbvh_speed").state, GoalState::reached);
  EXPECT_EQ(verdict_of(overall_verdicts(scenes), "sbvh_speed").state, GoalState::missed);
  row_of(scenes[0], Role::reinsertion).finished = false;
  EXPECT_EQ(verdict_of(overall_verdicts(scenes), "reinsertion").state, GoalState::not_measured) << "one is not known";
}

}  // namespace
}  // namespace kerf::test
