// Boxes, rounding and the parallel loop: what everything above takes for granted.

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <thread>
#include <vector>

#include "kerf/base/box3.h"
#include "kerf/base/fp_environment.h"
#include "kerf/base/parallel.h"
#include "kerf/base/rounding.h"
#include "kerf/base/transform.h"
#include "kerf/base/work_limit.h"
#include "tests/support/hostile_float.h"

namespace kerf {
namespace {

TEST(Box, DefaultIsEmptyAndHasNoArea) {
  const Box3f box;
  EXPECT_TRUE(box.is_empty());
  EXPECT_EQ(surface_area(box), 0);
  EXPECT_TRUE(Box3f({{0, 0, 0}, {1, 1, 1}}).contains(box));
}

TEST(Box, SurfaceAreaIsOfSixFacesAndDoesNotOverflow) {
  EXPECT_EQ(surface_area(Box3f{{0, 0, 0}, {1, 2, 3}}), 22);
  EXPECT_NEAR(surface_area(Box3f{{-1e30F, -1e30F, 0}, {1e30F, 1e30F, 0}}) / 8e60, 1, 1e-6);
}

TEST(Rounding, NextBelowAgreesWithNextafter) {
  for (const float x : {0.0F, -0.0F, 1.0F, -1.0F, 1e-45F, -1e-45F, 3.4e38F, -3.4e38F, 0.1F}) {
    EXPECT_EQ(next_below(x), std::nextafter(x, -std::numeric_limits<float>::infinity())) << x;
    EXPECT_EQ(next_above(x), std::nextafter(x, std::numeric_limits<float>::infinity())) << x;
  }
}

TEST(Rounding, EnclosesTheDouble) {
  for (const double x : {0.1, -0.1, 1.0 / 3, 1e-50, -1e-50, 16777217.0, 0.0}) {
    EXPECT_LE(round_down(x), x);
    EXPECT_GE(round_up(x), x);
    EXPECT_LE(round_up(x), next_above(round_down(x)));
  }
  EXPECT_EQ(std::signbit(without_minus_zero(-0.0F)), false);
}

TEST(Transform, TurnsByTheRightHand) {
  const Vec3d y = rotation(kZ, 90).vector({1, 0, 0});
  EXPECT_NEAR(y.x, 0, 1e-15);
  EXPECT_NEAR(y.y, 1, 1e-15);
  const Vec3d both = then(rotation(kX, 30), rotation(kY, 30)).vector({0, 0, 1});
  const Vec3d apart = rotation(kY, 30).vector(rotation(kX, 30).vector({0, 0, 1}));
  EXPECT_NEAR(largest(abs(both - apart)), 0, 1e-15);
}

TEST(Parallel, EveryBlockOnceForAnyThreadCount) {
  for (const int threads : {1, 2, 7}) {
    with_threads(threads, [&] {
      EXPECT_EQ(thread_count(), threads);
      std::vector<std::atomic<int>> seen(1000);
      parallel_for(seen.size(), 7, [&](size_t begin, size_t end) {
        EXPECT_EQ(begin % 7, 0U);
        for (size_t i = begin; i < end; ++i) ++seen[i];
      });
      for (const auto& count : seen) EXPECT_EQ(count, 1);
    });
  }
}

TEST(Parallel, ThreadsThatHelpWorkUnderTheSameLimit) {
  const WorkLimit limit;
  const LimitScope scope(&limit);
  std::atomic<int> others = 0;
  const auto look = [&] {
    std::this_thread::sleep_for(std::chrono::microseconds(200));  // so that others get some
    others += current_limit() == &limit ? 0 : 1;
  };
  with_threads(4, [&] {
    parallel_for(100, 1, [&](size_t, size_t) { look(); });
    for (int i = 0; i < 50; ++i) parallel_invoke(look, look);
  });
  EXPECT_EQ(others, 0);
}

TEST(Parallel, InvokeNestsAndRethrows) {
  std::atomic<int> leaves = 0;
  const auto tree = [&](const auto& self, int depth) -> void {
    if (depth == 0) {
      ++leaves;
      return;
    }
    parallel_invoke([&] { self(self, depth - 1); }, [&] { self(self, depth - 1); });
  };
  with_threads(7, [&] { tree(tree, 8); });
  EXPECT_EQ(leaves, 256);
  EXPECT_THROW(with_threads(2, [] { parallel_for(10, 1, [](size_t, size_t) { throw std::runtime_error("x"); }); }),
               std::runtime_error);
}

/// One part throws while the other one goes on with parallel work of its own, as a tree is built: what that work
/// returns from is done, or it throws too.
TEST(Parallel, WorkWithinWorkThatFailedIsDoneOrThrows) {
  using Clock = std::chrono::steady_clock;
  std::atomic<bool> is_started = false, is_thrown = false;
  std::atomic<size_t> undone = 0;
  const auto fail = [&] {
    for (const auto end = Clock::now() + std::chrono::seconds(5); !is_started && Clock::now() < end;) {
      std::this_thread::yield();
    }
    is_thrown = true;
    throw std::runtime_error("first");
  };
  const auto go_on = [&] {
    is_started = true;
    auto end = Clock::now() + std::chrono::seconds(5);
    for (bool was_thrown = false; Clock::now() < end;) {
      if (!was_thrown && is_thrown) {
        was_thrown = true;
        end = Clock::now() + std::chrono::milliseconds(50);
      }
      std::atomic<size_t> done = 0;
      parallel_invoke([&] { ++done; }, [&] { ++done; });
      parallel_for(8, 1, [&](size_t, size_t) { ++done; });
      undone += done == 10 ? 0 : 1;
    }
  };
  for (int i = 0; i < 4; ++i) {
    is_started = is_thrown = false;
    EXPECT_THROW(with_threads(2, [&] { parallel_invoke(fail, go_on); }), std::runtime_error);
    EXPECT_THROW(with_threads(2, [&] { parallel_invoke(go_on, fail); }), std::runtime_error);
  }
  EXPECT_EQ(undone, 0U);
}

#if defined(KERF_HOSTILE_FLOAT)
TEST(StandardFloat, OverridesTheCallersModeAndRestoresIt) {
  volatile float small = 1e-40F, one = 1;
  const test::HostileFloat hostile;
  {
    const StandardFloat standard;
    EXPECT_FALSE(test::HostileFloat::is_on());
    EXPECT_GT(small * 0.5F, 0.0F);
    EXPECT_EQ(one + small, 1.0F);
    parallel_for(4, 1, [&](size_t, size_t) {
      EXPECT_GT(small * 0.5F, 0.0F);
      EXPECT_EQ(one + 1e-20F, 1.0F);
    });
  }
  EXPECT_TRUE(test::HostileFloat::is_on());
  EXPECT_EQ(small * 0.5F, 0.0F);
  EXPECT_GT(one + 1e-20F, 1.0F);
}

TEST(StandardFloat, SeesEachWayThatAModeMayDiffer) {
  for (const test::HostileFloat::Control what : test::HostileFloat::kEach) {
    const test::HostileFloat hostile(what);
    ASSERT_TRUE(test::HostileFloat::is_on(what));
    {
      const StandardFloat standard;
      EXPECT_TRUE(test::HostileFloat::is_off()) << what;
      const StandardFloat within;
      EXPECT_TRUE(test::HostileFloat::is_off()) << what;
    }
    EXPECT_TRUE(test::HostileFloat::is_on(what)) << what;
  }
}
#endif

}  // namespace
}  // namespace kerf
