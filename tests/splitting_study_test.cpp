// Studies of splitting: what is counted is what the scene does, checks are of what they say, limits and interrupts.

#include "kerf/study/splitting_study.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "kerf/render/render_scene.h"
#include "kerf/study/splitting_goals.h"
#include "kerf/study/turn.h"
#include "tests/support/random_study.h"

namespace kerf::test {
namespace {

using Role = SplittingRole;

SplittingOptions quick() {
  SplittingOptions options;
  options.width = 40;
  options.height = 30;
  options.repeat = 6;
  return options;
}

TEST(SplittingStudy, CountsAreThoseOfTheScene) {
  const StudyScene scene = random_study(1500);
  const SplittingOptions options = quick();
  const SplittingScene result = study_splitting(scene, "straight", options);
  EXPECT_EQ(result.title(), "random");
  EXPECT_EQ(result.triangles, 1500U);
  ASSERT_EQ(result.rows.size(), splitting_study_rows().size() + splitting_budgets().size());
  const std::vector<StudyRays> rays =
      make_study_rays(scene.description, scene.camera, options.width, options.height, options.kinds);
  for (const SplittingRow& row : result.rows) {
    if (!row.finished) {
      EXPECT_NE(row.why_not.find("not in the menu"), std::string::npos) << row.pipeline << ": " << row.why_not;
      continue;
    }
    const Scene built = build_scene(scene.description, {.structure = row.pipeline});
    EXPECT_EQ(row.references_per_primitive, built.report().references_per_primitive);
    EXPECT_EQ(row.tree_hash, built.report().tree_hash);
    ASSERT_TRUE(row.peak_bytes) << row.pipeline;
    EXPECT_GE(*row.peak_bytes, row.bytes) << row.pipeline;
    EXPECT_LE(*row.peak_bytes, built.memory_need({.structure = row.pipeline}).most) << row.pipeline;
    for (size_t k = 0; k < rays.size(); ++k) {
      TraceCounts counts;
      for (const Ray& ray : rays[k].rays) {
        rays[k].any_hit ? void(built.any_hit(ray, counts)) : void(built.closest_hit(ray, counts));
      }
      EXPECT_EQ(row.rays[k].nodes, static_cast<double>(counts.nodes) / static_cast<double>(rays[k].rays.size()));
      const bool is_timed = row.role != Role::budget && splitting_row(row.role).is_timed;
      EXPECT_EQ(row.rays[k].seconds.size(), is_timed ? 6U : 0U) << row.pipeline;
    }
    if (row.role == Role::budget) {
      EXPECT_NEAR(row.references_per_primitive, row.budget, 0.01);
    }
  }
  EXPECT_EQ(result.row(Role::plain)->builds.size(), result.row(Role::automatic)->builds.size());
}

TEST(SplittingStudy, ChecksAreMade) {
  const SplittingScene result = study_splitting(random_study(1500), "straight", quick());
  EXPECT_EQ(result.variants.size(), 3U);
  ASSERT_FALSE(result.trees.empty());
  EXPECT_EQ(result.trees[0].threads, (std::vector<int>{1, 2, 7}));
  EXPECT_EQ(result.trees[0].hashes[2], result.row(Role::automatic)->tree_hash);
  ASSERT_TRUE(result.capped_references);
  EXPECT_LE(*result.capped_references, kSplittingCap);
  ASSERT_TRUE(result.refusal);
  EXPECT_TRUE(result.refusal->is_refused);
  EXPECT_TRUE(result.skipped.empty());
  for (const GoalVerdict& verdict : scene_verdicts(result)) {
    if (verdict.goal->id == "follows" || verdict.goal->id == "cap" || verdict.goal->id == "hits" ||
        verdict.goal->id == "peak") {
      EXPECT_EQ(verdict.state, GoalState::reached) << verdict.goal->id << ": " << verdict.text;
    }
  }
}

TEST(SplittingStudy, WhatIsLeftOutSaysSo) {
  SplittingOptions options = quick();
  options.with_threads = false;
  options.limit_bytes = 100000;
  const SplittingScene result = study_splitting(random_study(1500), "x", options);
  EXPECT_TRUE(result.trees.empty());
  EXPECT_EQ(result.title(), "random turned x");
  EXPECT_GE(result.skipped.size(), 2U);
  for (const SplittingRow& row : result.rows) EXPECT_FALSE(row.finished) << row.pipeline;
}

TEST(SplittingStudy, AnInterruptKeepsWhatIsFinished) {
  SplittingOptions options = quick();
  std::atomic<bool> cancelled = false;
  options.cancelled = &cancelled;
  int steps = 0;
  options.progress = [&](double done, std::string_view) {
    EXPECT_LE(done, 1);
    if (++steps == 5) cancelled = true;  // plain and auto are built and counted
    return !cancelled;
  };
  const SplittingScene result = study_splitting(random_study(1500), "straight", options);
  EXPECT_TRUE(result.rows[0].finished);
  EXPECT_TRUE(result.rows[1].finished);
  for (size_t i = 2; i < result.rows.size(); ++i) {
    EXPECT_FALSE(result.rows[i].finished);
    EXPECT_EQ(result.rows[i].why_not, "it was interrupted");
  }
  EXPECT_TRUE(result.variants.empty());
}

TEST(SplittingStudy, TakesAnEmptyScene) {
  StudyScene scene = random_study(1500);
  scene.description.objects.clear();
  const SplittingScene result = study_splitting(scene, "straight", quick());
  EXPECT_TRUE(result.row(Role::plain)->finished);
  EXPECT_EQ(result.triangles, 0U);
  for (const GoalVerdict& verdict : scene_verdicts(result)) EXPECT_NE(verdict.state, GoalState::missed);
}

TEST(Turn, ExchangedAndScaledScenesKeepTheirShape) {
  StudyScene scene = random_study(1500);
  scene.description.objects.push_back({Sphere{{1, 2, 3}, 0.5F}, 0, true, ""});
  const SceneDescription large = scaled(scene.description, 1000), other = turned(scene.description, axes_exchanged());
  const auto& mesh = std::get<Mesh>(scene.description.objects[0].shape);
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Vec3f v = mesh.vertices[i];
    EXPECT_EQ(std::get<Mesh>(other.objects[0].shape).vertices[i], (Vec3f{v.z, v.x, v.y}));
    EXPECT_FLOAT_EQ(std::get<Mesh>(large.objects[0].shape).vertices[i].x, v.x * 1000);
  }
  EXPECT_EQ(std::get<Sphere>(large.objects[1].shape).radius, 500);
  EXPECT_EQ(std::get<Sphere>(large.objects[1].shape).center, (Vec3f{1000, 2000, 3000}));
}

}  // namespace
}  // namespace kerf::test
