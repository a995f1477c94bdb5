// Builds tell how far they are and end when told to: everything in the menu, and what counts underneath.

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <string>
#include <vector>

#include "kerf/base/parallel.h"
#include "kerf/build/builders.h"
#include "kerf/scene/scene.h"
#include "tests/support/error_of.h"
#include "tests/support/random_scene.h"
#include "tests/support/sizes.h"
#include "tests/support/structures.h"

namespace kerf::test {
namespace {

constexpr uint32_t kTriangles = kManyThings / 4;
constexpr Ray kRay{.origin = {0.1F, 0.2F, 30}, .direction = {0, 0, -1}};

/// Keeps what it is told, and sees that it is told one thing at a time.
struct Listener {
  std::vector<double> shares;
  std::vector<std::string> words;
  std::atomic<int> inside = 0;
  bool is_alone = true;

  bool operator()(double share, std::string_view what) {
    is_alone = is_alone && inside++ == 0;
    shares.push_back(share);
    words.emplace_back(what);
    --inside;
    return true;
  }
};

class EveryPipeline : public testing::TestWithParam<std::string> {
 protected:
  BuildOptions options(WorkMeter::Progress progress, int threads = 3) const {
    BuildOptions options;
    options.structure = GetParam();
    options.threads = threads;
    options.progress = std::move(progress);
    return options;
  }

  /// Builds something simple, then tries `options`, which must throw; the scene must answer as before.
  template <class Exception>
  void expect_thrown(const BuildOptions& options) const {
    Scene scene;
    scene.add(triangles_.geometry());
    const uint64_t hash = scene.build({.structure = "object_median"}).tree_hash;
    const Hit hit = scene.closest_hit(kRay);
    EXPECT_THROW(scene.build(options), Exception);
    EXPECT_EQ(scene.report().tree_hash, hash);
    EXPECT_EQ(scene.closest_hit(kRay), hit);
  }

  const RandomTriangles triangles_{kTriangles};
};

TEST_P(EveryPipeline, TellsHowFarItIs) {
  Scene plain, told;
  plain.add(triangles_.geometry());
  told.add(triangles_.geometry());
  Listener listener;
  const auto start = std::chrono::steady_clock::now();
  const BuildReport& report = told.build(options(std::ref(listener)));
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  EXPECT_EQ(report.tree_hash, plain.build(options(nullptr, 1)).tree_hash);
  ASSERT_GE(listener.shares.size(), 2U);
  EXPECT_EQ(listener.shares.front(), 0);
  EXPECT_EQ(listener.shares.back(), 1);
  EXPECT_TRUE(std::is_sorted(listener.shares.begin(), listener.shares.end()));
  EXPECT_TRUE(listener.is_alone);
  for (const std::string& what : listener.words) EXPECT_FALSE(what.empty());
  EXPECT_LE(static_cast<double>(listener.shares.size()), 4 + seconds * 2 * 20);
}

TEST_P(EveryPipeline, EndsWhenItIsNotWanted) {
  int calls = 0;
  expect_thrown<Error>(options([&](double, std::string_view) {
    ++calls;
    return false;
  }));
  EXPECT_EQ(calls, 1) << "not called again";
  expect_thrown<Error>(options([](double share, std::string_view) { return share == 0; }));
  std::atomic<bool> cancelled = false;
  BuildOptions by_flag = options([&](double, std::string_view) {
    cancelled = true;
    return true;
  });
  by_flag.limit.cancelled = &cancelled;
  expect_thrown<Error>(by_flag);
}

TEST_P(EveryPipeline, HandsOnWhatProgressThrows) {
  expect_thrown<std::domain_error>(options([](double share, std::string_view) -> bool {
    if (share == 0) return true;
    throw std::domain_error("mine");
  }));
}

INSTANTIATE_TEST_SUITE_P(Menu, EveryPipeline, testing::ValuesIn(menu_pipelines()),
                         [](const auto& one) { return test_name(one.param); });

TEST(Progress, OfAnEmptySceneAndOfOneThatWasMovedFrom) {
  Scene scene;
  Listener listener;
  BuildOptions options;
  options.progress = std::ref(listener);
  scene.build(options);
  EXPECT_EQ(listener.shares, (std::vector<double>{0, 1}));
  const Scene other = std::move(scene);
  EXPECT_NO_THROW(scene.build());  // NOLINT(bugprone-use-after-move): it starts anew
}

TEST(Progress, MayUseOtherScenes) {
  const RandomTriangles triangles(kTriangles);
  Scene scene;
  scene.add(triangles.geometry());
  int inner_calls = 0;
  BuildOptions inner, outer;
  inner.progress = [&](double, std::string_view) { return ++inner_calls > 0; };
  outer.progress = [&](double, std::string_view) {
    Scene other;
    other.add(triangles.geometry());
    other.build(inner);
    return other.closest_hit(kRay).t > 0;
  };
  EXPECT_NO_THROW(scene.build(outer));
  EXPECT_GE(inner_calls, 4);
}

/// The share that a builder has told of when it is done.
double share_at_end(const BuilderEntry& builder, const RandomTriangles& triangles) {
  const std::vector<Geometry> geometries{triangles.geometry()};
  const std::span<const Geometry> all = geometries;
  double told = 0;
  WorkMeter meter([&](double share, std::string_view) {
    told = share;
    return true;
  });
  WorkLimit limit;
  limit.meter = &meter;
  meter.begin_stage("build", 1);
  builder.build({make_references(all).references, geometry_clipper(all), limit}, OptionValues(builder.options));
  meter.tell(true);
  return told;
}

TEST(Progress, OfBuildersAddsUp) {
  const RandomTriangles triangles(kTriangles);
  for (const BuilderEntry& builder : builders()) {
    const double share = share_at_end(builder, triangles);
    EXPECT_GT(share, 0.6) << builder.name;
    EXPECT_LE(share, 1) << builder.name;
    if (builder.name.ends_with("sah") || builder.name.ends_with("median")) {
      EXPECT_NEAR(share, 1, 1e-9) << builder.name;
    }
  }
}

TEST(WorkMeter, StagesAndPartsDivideWhatIsLeft) {
  std::vector<double> told;
  WorkMeter meter([&](double share, std::string_view) {
    told.push_back(share);
    return true;
  });
  WorkLimit limit;
  limit.meter = &meter;
  meter.begin_stage("first", 0.5);
  {
    const ProgressPart part(limit, 0.5);
    limit.plan(10);
    meter.advance(5);
    meter.tell(true);  // half of half of a half
    meter.plan(2);
    meter.advance(1);
    meter.tell(true);
    meter.advance(1);
    meter.tell(true);
    meter.advance(7);  // more than was planned
    meter.tell(true);
  }
  limit.plan(4);
  meter.advance(2);
  meter.tell(true);
  meter.begin_stage("second", 1);
  meter.tell(true);
  meter.begin_stage("third", 0.7);  // less than the share that is done
  meter.tell(true);
  EXPECT_EQ(told, (std::vector<double>{0.125, 0.1875, 0.25, 0.25, 0.375, 0.5, 1}));
}

TEST(WorkMeter, NeverTellsLessThanBefore) {
  std::vector<double> told;
  WorkMeter meter([&](double share, std::string_view) {
    told.push_back(share);
    return true;
  });
  meter.begin_stage("only", 1);
  meter.plan(4);
  meter.advance(3);
  meter.tell(true);
  meter.advance(-2);  // what was thought to be done is not
  meter.tell(true);
  EXPECT_EQ(told, (std::vector<double>{0.75, 0.75}));
}

TEST(WorkMeter, CountsWhatIsHeld) {
  WorkMeter meter;
  WorkLimit limit;
  limit.meter = &meter;
  limit.bytes = 1000;
  const LimitScope scope(&limit);
  {
    HeldBytes held(300);
    HeldBytes more(400);
    held.set(100);
    more = std::move(held);
    EXPECT_EQ(more.bytes(), 100U);
    error_of(ErrorCode::stopped, [&] { more.set(1001); });
  }
  EXPECT_EQ(meter.peak(), 1001U);
  EXPECT_EQ(meter.hold(0), 0U) << "all is given back";
}

TEST(CurrentLimit, GoesWithParallelWork) {
  WorkLimit limit;
  std::atomic<bool> cancelled = false;
  limit.cancelled = &cancelled;
  with_threads(4, [&] {
    const LimitScope scope(&limit);
    std::atomic<int> others = 0;
    parallel_for(100, 1, [&](size_t, size_t) {
      parallel_invoke([&] { others += current_limit() != &limit ? 1 : 0; },
                      [&] { others += current_limit() != &limit ? 1 : 0; });
    });
    EXPECT_EQ(others, 0);
    cancelled = true;
    std::atomic<int> done = 0;
    error_of(ErrorCode::stopped, [&] { parallel_for(100, 1, [&](size_t, size_t) { ++done; }); });
    error_of(ErrorCode::stopped, [&] { parallel_invoke([&] { ++done; }, [&] { ++done; }); });
    EXPECT_EQ(done, 0);
  });
  EXPECT_EQ(current_limit(), nullptr);
}

}  // namespace
}  // namespace kerf::test
