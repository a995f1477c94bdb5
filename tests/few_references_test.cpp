// The best division of few references, against all divisions that there are.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "kerf/build/few_references.h"

namespace kerf::test {
namespace {

Reference box(Vec3f lower, Vec3f upper, uint32_t primitive) { return {lower, 0, upper, primitive}; }

double cost_of(std::span<const Reference> all, const std::vector<bool>& is_left) {
  Box3f sides[2];
  double counts[2] = {0, 0};
  for (size_t i = 0; i < all.size(); ++i) {
    sides[is_left[i] ? 0 : 1].extend(all[i].bounds());
    ++counts[is_left[i] ? 0 : 1];
  }
  return half_area(sides[0]) * counts[0] + half_area(sides[1]) * counts[1];
}

/// The least cost of putting those with centres up to one of them on the left, along any axis; infinite if all centres
/// are in one place.
double least_cost(std::span<const Reference> all) {
  double least = std::numeric_limits<double>::infinity();
  for (uint32_t axis = 0; axis < 3; ++axis) {
    const auto center = [&](const Reference& r) { return r.lower[axis] + r.upper[axis]; };
    for (const Reference& last : all) {
      std::vector<bool> is_left;
      for (const Reference& r : all) is_left.push_back(center(r) <= center(last));
      if (std::count(is_left.begin(), is_left.end(), false) > 0) least = std::min(least, cost_of(all, is_left));
    }
  }
  return least;
}

TEST(FewReferences, AreDividedWhereThatCostsLeast) {
  std::mt19937 random(1);
  std::uniform_int_distribution<int> place(0, 4), size(0, 3), count(2, FewReferences::kMost);  // many are equal
  for (int round = 0; round < 2000; ++round) {
    std::vector<Reference> all;
    for (int i = count(random); i > 0; --i) {
      const auto at = [&] { return static_cast<float>(place(random)); };
      const auto more = [&] { return static_cast<float>(size(random)); };
      const Vec3f lower{at(), at(), at()};
      all.push_back(box(lower, lower + Vec3f{more(), more(), more()}, static_cast<uint32_t>(all.size())));
    }
    const FewReferences division(all);
    ASSERT_EQ(division.cost(), least_cost(all));
    ASSERT_EQ(division.is_divided(), !std::isinf(least_cost(all)));
    if (!division.is_divided()) continue;
    std::vector<Reference> arranged = all;
    division.arrange(arranged);
    Box3f left, right;
    for (size_t i = 0; i < arranged.size(); ++i) (i < division.left() ? left : right).extend(arranged[i].bounds());
    ASSERT_EQ(left, division.left_bounds());
    ASSERT_EQ(right, division.right_bounds());
    std::vector<uint32_t> primitives;
    primitives.reserve(arranged.size());
    for (const Reference& r : arranged) primitives.push_back(r.primitive);
    std::sort(primitives.begin(), primitives.end());
    for (uint32_t i = 0; i < primitives.size(); ++i) ASSERT_EQ(primitives[i], i) << "none is lost";
  }
}

TEST(FewReferences, OfOneCentreAreNotDivided) {
  const std::vector<Reference> all{box({0, 0, 0}, {2, 2, 2}, 0), box({-1, -1, -1}, {3, 3, 3}, 1)};
  EXPECT_FALSE(FewReferences(all).is_divided());
}

}  // namespace
}  // namespace kerf::test
