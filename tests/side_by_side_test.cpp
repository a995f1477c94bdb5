// References put on the two sides of a plane: none lost, boxes around each side, the same order for any number of
// threads.

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "kerf/build/side_by_side.h"

namespace kerf::test {
namespace {

std::vector<Reference> random_references(size_t count, uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(-1, 1);
  std::vector<Reference> references(count);
  for (uint32_t i = 0; i < count; ++i) {
    const Vec3f a{place(random), place(random), place(random)}, b{place(random), place(random), place(random)};
    references[i] = {min(a, b), 0, max(a, b), i};
  }
  return references;
}

Subset reference_subset(std::span<const Reference> references, uint32_t begin, uint32_t end) {
  Subset subset{begin, end, {}, {}};
  for (uint32_t i = begin; i < end; ++i) {
    subset.bounds.extend(references[i].bounds());
    subset.centers.extend(references[i].lower + references[i].upper);
  }
  return subset;
}

void expect_same(const Subset& a, const Subset& b) {
  EXPECT_EQ(a.begin, b.begin);
  EXPECT_EQ(a.end, b.end);
  EXPECT_EQ(a.bounds, b.bounds);
  EXPECT_EQ(a.centers, b.centers);
}

TEST(SideBySide, PutsEachOnItsSideWhateverTheThreads) {
  for (const uint32_t count : {1U, 2U, 511U, 512U, 513U, 1024U, 5000U, 65535U, 65536U, 100001U}) {
    for (const float plane : {-3.0F, -1.0F, 0.0F, 0.7F, 3.0F}) {
      const auto goes_left = [plane](const Reference& r) { return r.lower.x + r.upper.x < plane; };
      const std::vector<Reference> given = random_references(count + 2, count);
      std::vector<Reference> first;
      for (const int threads : {1, 2, 7}) {
        std::vector<Reference> references = given;
        const Subset subset{1, count + 1, {}, {}};
        Halves halves;
        with_threads(threads, [&] { halves = detail::put_side_by_side(references, subset, goes_left); });
        const uint32_t middle = halves.left.end;
        ASSERT_TRUE(std::all_of(references.begin() + 1, references.begin() + middle, goes_left));
        ASSERT_TRUE(std::none_of(references.begin() + middle, references.end() - 1, goes_left));
        expect_same(halves.left, reference_subset(references, 1, middle));
        expect_same(halves.right, reference_subset(references, middle, count + 1));
        if (threads == 1) first = references;
        ASSERT_EQ(references, first) << threads << " threads";
        ASSERT_EQ(references.front(), given.front());
        ASSERT_EQ(references.back(), given.back());
        std::sort(references.begin(), references.end(),
                  [](const Reference& a, const Reference& b) { return a.primitive < b.primitive; });
        ASSERT_EQ(references, given) << "none is lost";
      }
    }
  }
}

TEST(SideBySide, MeasuresWhatItIsGiven) {
  for (const uint32_t count : {0U, 1U, 77U, 70000U}) {
    const std::vector<Reference> references = random_references(count + 1, count);
    expect_same(detail::measured(references, 1, count + 1), reference_subset(references, 1, count + 1));
  }
}

}  // namespace
}  // namespace kerf::test
