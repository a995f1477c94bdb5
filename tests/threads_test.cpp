// Builds and queries from several threads at once; meant for the thread sanitizer.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "kerf/scene/scene.h"
#include "tests/support/random_scene.h"

namespace kerf {
namespace {

std::vector<Ray> some_rays(size_t count) {
  std::vector<Ray> rays(count);
  for (size_t i = 0; i < count; ++i) {
    const float a = static_cast<float>(i) * 0.37F, b = static_cast<float>(i) * 0.11F;
    rays[i] = {.origin = {12 * std::sin(a), 12 * std::cos(a), 12 * std::sin(b)},
               .direction = {-std::sin(a + 0.3F), -std::cos(a), -std::sin(b)}};
  }
  return rays;
}

TEST(Threads, QueriesFromManyThreadsAgree) {
  const test::RandomTriangles triangles(4000);
  Scene scene;
  scene.add(triangles.geometry());
  scene.build({.structure = "early_split(budget=2)+binned_sah", .threads = 7});
  const std::vector<Ray> rays = some_rays(4000);
  std::vector<Hit> expected(rays.size());
  scene.closest_hit(rays, expected, 1);
  EXPECT_GT(std::count_if(expected.begin(), expected.end(), [](const Hit& hit) { return bool(hit); }), 100);
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] {
      std::vector<Hit> hits(rays.size());
      std::vector<uint8_t> any(rays.size());
      scene.closest_hit(rays, hits, 3);
      scene.any_hit(rays, any, 3);
      EXPECT_EQ(hits, expected);
      for (size_t k = 0; k < rays.size(); ++k) EXPECT_EQ(any[k] != 0, bool(expected[k]));
    });
  }
  for (std::thread& thread : threads) thread.join();
}

TEST(Threads, ScenesBuildAtOnceWithoutDisturbingEachOther) {
  const test::RandomTriangles triangles(5000);
  std::vector<uint64_t> hashes(6);
  std::vector<std::thread> threads;
  for (size_t i = 0; i < hashes.size(); ++i) {
    threads.emplace_back([&, i] {
      Scene scene;
      scene.add(triangles.geometry());
      hashes[i] =
          scene.build({.structure = "early_split(budget=1.5)+sweep_sah", .threads = static_cast<int>(i)}).tree_hash;
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const uint64_t hash : hashes) EXPECT_EQ(hash, hashes[0]);
}

}  // namespace
}  // namespace kerf
