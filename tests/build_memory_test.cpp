// The memory of builds: as much as they say, no more than was said before, and a limit is honoured.

#include <gtest/gtest.h>

#include <string>

#include "kerf/scene/scene.h"
#include "tests/support/error_of.h"
#include "tests/support/random_scene.h"
#include "tests/support/sizes.h"
#include "tests/support/structures.h"

#ifndef KERF_SANITIZED  // whose own allocator would be left out
#include "tests/support/counted_heap.h"

namespace kerf::test {
namespace {

constexpr uint32_t kTriangles = kManyThings;

BuildOptions with_bytes(const std::string& structure, size_t bytes) {
  BuildOptions options;
  options.structure = structure;
  options.limit.bytes = bytes;
  return options;
}

class EveryPipeline : public testing::TestWithParam<std::string> {
 protected:
  EveryPipeline() { scene_.add(triangles_.geometry()); }

  const RandomTriangles triangles_{kTriangles, 1, 0.02F};
  Scene scene_;
};

TEST_P(EveryPipeline, TakesWhatItSays) {
  scene_.build({.structure = GetParam()});  // what is made once and kept does not count
  scene_ = {};
  scene_.add(triangles_.geometry());
  const size_t peak = heap_peak([&] { scene_.build({.structure = GetParam()}); });
  const BuildReport& report = scene_.report();
  EXPECT_GE(report.peak_bytes, report.bytes);
  const MemoryNeed need = scene_.memory_need({.structure = GetParam()});
  // What small cells of the structures that are no trees of boxes take while they are divided is not counted.
  const double tolerance = need.most != MemoryNeed::kUnbounded ? 0.1 : 0.2;
  EXPECT_NEAR(static_cast<double>(report.peak_bytes), static_cast<double>(peak), tolerance * static_cast<double>(peak));
  EXPECT_LE(peak, need.most);
}

TEST_P(EveryPipeline, RefusesTooLittleBeforeItWorks) {
  const size_t least = scene_.memory_need({.structure = GetParam()}).least;
  ASSERT_GT(least, 0U);
  BuildOptions options = with_bytes(GetParam(), least - 1);
  int calls = 0;
  options.progress = [&](double, std::string_view) { return ++calls > 0; };
  std::string words;
  const size_t peak = heap_peak([&] { words = error_of(ErrorCode::stopped, [&] { scene_.build(options); }); });
  EXPECT_NE(words.find("it needs " + std::to_string(least) + " bytes, and " + std::to_string(least - 1)),
            std::string::npos)
      << words;
  EXPECT_EQ(calls, 0);
  EXPECT_LT(peak, 20'000U) << "nothing large was made";
}

/// With what is asked for at least, a tree of boxes is always finished, with fewer references where it has to be.
TEST_P(EveryPipeline, KeepsToItsLimit) {
  const MemoryNeed need = scene_.memory_need({.structure = GetParam()});
  for (const size_t bytes : {need.least, need.least + need.least / 4, need.least * 2}) {
    const size_t peak = heap_peak([&] {
      try {
        scene_ = {};
        scene_.add(triangles_.geometry());
        scene_.build(with_bytes(GetParam(), bytes));
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::stopped);
        EXPECT_EQ(need.most, MemoryNeed::kUnbounded) << error.what();
      }
    });
    EXPECT_LE(static_cast<double>(peak), 1.5 * static_cast<double>(bytes));
    if (need.most != MemoryNeed::kUnbounded) {
      EXPECT_LE(peak, bytes);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Menu, EveryPipeline, testing::ValuesIn(menu_pipelines()),
                         [](const auto& one) { return test_name(one.param); });

TEST(Memory, FewerReferencesAreMadeWhereItIsShort) {
  const RandomTriangles triangles(kTriangles);
  for (const char* structure : {"early_split(budget=4)+binned_sah", "early_split(sa_max=0.01)+binned_sah",
                                "refine(budget=4)+binned_sah", "spatial_split(cap=8)"}) {
    Scene scene;
    scene.add(triangles.geometry());
    const double all = scene.build({.structure = structure}).references_per_primitive;
    const size_t bytes = scene.memory_need({.structure = structure}).least * 3 / 2;
    const BuildReport& report = scene.build(with_bytes(structure, bytes));
    EXPECT_LT(report.references_per_primitive, all) << structure;
    EXPECT_GT(report.references_per_primitive, 1.1) << structure;
    EXPECT_LE(report.peak_bytes, bytes) << structure;
    if (std::string(structure).find('+') != std::string::npos) {
      EXPECT_TRUE(report.capped) << structure;
    }
    const std::string first = std::string(structure).substr(0, std::string(structure).find('('));
    EXPECT_EQ(report.short_of_room, std::vector<std::string>{first}) << structure;
  }
}

TEST(Memory, OfTheUsualTreesIsAtMostTwoAndAHalfTimesTheTree) {
  const RandomTriangles triangles(kTriangles, 3);
  for (const char* structure : {"binned_sah", "binned_sah+reinsertion", "early_split(auto,cap=1.2)+binned_sah"}) {
    Scene scene;
    scene.add(triangles.geometry());
    const size_t peak = heap_peak([&] { scene.build({.structure = structure}); });
    EXPECT_LE(static_cast<double>(peak), 2.5 * static_cast<double>(scene.report().bytes)) << structure;
  }
}

TEST(Memory, NeedGrowsWithTheCap) {
  Scene scene;
  const RandomTriangles triangles(1000);
  EXPECT_EQ(scene.memory_need().least, 0U);
  scene.add(triangles.geometry());
  const MemoryNeed two = scene.memory_need({.structure = "early_split(budget=2)+binned_sah"});
  const MemoryNeed four = scene.memory_need({.structure = "early_split(budget=4)+binned_sah"});
  EXPECT_EQ(two.least, four.least);
  EXPECT_LT(two.most, four.most);
  EXPECT_EQ(scene.memory_need({.structure = "kd_sah"}).most, MemoryNeed::kUnbounded);
  error_of(ErrorCode::invalid_option, [&] { scene.memory_need({.structure = "kd_shah"}); });
}

TEST(BuildMemory, WhatRefitsNeedCounts) {
  const RandomTriangles triangles(20000);
  for (const std::string layout : {"bvh2", "bvh8"}) {
    const auto build = [&](bool refittable) {
      Scene scene;
      scene.add(triangles.geometry());
      scene.build({.structure = "early_split(budget=4)+binned_sah+" + layout, .refittable = refittable});
      return scene;
    };
    const size_t peak = heap_peak([&] { build(true); });
    Scene scene = build(true);
    EXPECT_NEAR(static_cast<double>(scene.report().peak_bytes), static_cast<double>(peak),
                0.1 * static_cast<double>(peak));
    EXPECT_GT(scene.report().peak_bytes, build(false).report().peak_bytes + 8 * 20000) << layout;
    EXPECT_GT(scene.refit().bytes, 8 * 20000U) << layout;
  }
}

}  // namespace
}  // namespace kerf::test
#else
#include <gtest/gtest.h>

TEST(Memory, IsCountedWithoutASanitizer) {
  GTEST_SKIP() << "a sanitizer has an allocator of its own, which cannot be counted: the release build tests this";
}
#endif
