// References along a space-filling curve: the sort, the codes, and the order of equal ones.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <tuple>
#include <vector>

#include "kerf/base/mix.h"
#include "kerf/base/parallel.h"
#include "kerf/base/radix_sort.h"
#include "kerf/build/morton_order.h"
#include "tests/support/cubes.h"
#include "tests/support/property.h"

namespace kerf::test {
namespace {

std::vector<uint32_t> primitives_of(std::span<const Reference> references) {
  std::vector<uint32_t> primitives;
  for (const Reference& r : references) primitives.push_back(r.primitive);
  return primitives;
}

TEST(RadixSort, SortsAsTheStableSortOfTheLibrary) {
  check_property(60, [] {
    const int largest = draw_int(0, 9) == 0 ? 60000 : 300;  // of several blocks now and then
    Random random(static_cast<uint64_t>(draw_int(0, 1 << 30)));
    // Few different keys, or keys that differ in few digits.
    const uint64_t differing = random.bits() & random.bits(), common = random.bits() & ~differing;
    const bool few = draw_int(0, 1) == 0;
    std::vector<KeyedNumber> items(static_cast<size_t>(draw_int(0, largest)));
    for (uint32_t i = 0; i < items.size(); ++i) {
      items[i] = {few ? mix(random.below(5)) : common | (random.bits() & differing), i};
    }
    std::vector<KeyedNumber> expected = items;
    std::stable_sort(expected.begin(), expected.end(),
                     [](const KeyedNumber& a, const KeyedNumber& b) { return a.key < b.key; });
    radix_sort(items);
    RC_ASSERT(items == expected);
  });
}

/// Whether cells come in this order along the curve: bit by bit from the highest, the axes as given.
bool precedes(const std::array<uint32_t, 3>& a, const std::array<uint32_t, 3>& b, std::span<const uint32_t> axes) {
  for (uint32_t bit = kMortonBits; bit-- > 0;) {
    for (const uint32_t axis : axes) {
      if ((a[axis] >> bit & 1) != (b[axis] >> bit & 1)) return (a[axis] >> bit & 1) == 0;
    }
  }
  return false;
}

TEST(MortonOrder, ComparesCellsBitByBit) {
  check_property(100, [] {
    // Whole numbers in a space that is 2048 long, so that a cell is the 1024th part of one: exact.
    const std::array<uint32_t, 3> axes[] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    const std::array<uint32_t, 3>& order = axes[draw_int(0, 3)];
    const int extent[] = {2048, draw_int(100, 2047), draw_int(1, 99)};
    std::vector<Reference> references{cube_at({}, 0, 0)};
    Vec3f farthest;
    for (uint32_t k = 0; k < 3; ++k) farthest[order[k]] = static_cast<float>(extent[k]);
    references.push_back(cube_at(farthest, 1, 0));
    for (int i = draw_int(0, 60); i > 0; --i) {
      Vec3f p;
      for (uint32_t k = 0; k < 3; ++k) p[order[k]] = static_cast<float>(draw_int(0, extent[k]));
      references.push_back(cube_at(p, static_cast<uint32_t>(references.size()), 0));
    }
    const auto cells = [&](const Reference& r) {
      std::array<uint32_t, 3> cell{};
      for (uint32_t axis = 0; axis < 3; ++axis) {
        cell[axis] = std::min(static_cast<uint32_t>(r.lower[axis]) << 10, (1U << kMortonBits) - 1);
      }
      return cell;
    };
    std::vector<Reference> expected = references;
    std::stable_sort(expected.begin(), expected.end(),
                     [&](const Reference& a, const Reference& b) { return precedes(cells(a), cells(b), order); });
    shuffle(references, 3);
    const MortonOrder ordered = morton_order(references, {});
    RC_ASSERT(primitives_of(ordered.references) == primitives_of(expected));
    RC_ASSERT(std::is_sorted(ordered.codes.begin(), ordered.codes.end()));
    RC_ASSERT(ordered.codes.back() < uint64_t{1} << (3 * kMortonBits));
  });
}

TEST(MortonOrder, IsTheSameAtAnySizeAndForAnyOrderOfAxes) {
  Random random(4);
  std::vector<Reference> references(5000);
  for (uint32_t i = 0; i < references.size(); ++i) {
    const Vec3f p = random.vector();
    references[i] = cube_at({p.x, 0.7F * p.y, 0.3F * p.z}, i, 0);
  }
  const std::vector<uint32_t> expected = primitives_of(morton_order(references, {}).references);
  for (const int power : {-100, -20, 20, 119}) {
    std::vector<Reference> scaled = references;
    for (Reference& r : scaled) r.lower = r.upper = std::ldexp(1.0F, power) * r.lower;
    EXPECT_EQ(primitives_of(morton_order(scaled, {}).references), expected) << power;
  }
  std::vector<Reference> turned = references;
  for (Reference& r : turned) r.lower = r.upper = {r.lower.z, r.lower.x, r.lower.y};
  EXPECT_EQ(primitives_of(morton_order(turned, {}).references), expected);
}

TEST(MortonOrder, TinyAndHugeCoordinatesHaveDifferentCells) {
  for (const float size : {1e-40F, 1e-30F, 1e30F, 1.3e36F}) {
    std::vector<Reference> references;
    for (uint32_t i = 0; i < 9; ++i) {
      const float x = size * (static_cast<float>(i) / 4 - 1);
      references.push_back({{x, -x, x}, 0, {x, -x, x}, i});
    }
    const MortonOrder order = morton_order(references, {});
    for (size_t i = 1; i < 9; ++i) EXPECT_LT(order.codes[i - 1], order.codes[i]) << size;
  }
}

TEST(MortonOrder, EqualCodesAreOrderedByGeometryPrimitiveBox) {
  std::vector<Reference> references;
  for (uint32_t i = 0; i < 40000; ++i) {
    const auto width = static_cast<float>(i % 4);
    references.push_back({{-width, 0, 0}, i / 4 % 2, {width, 0, 0}, i / 8});
  }
  std::vector<Reference> shuffled = references;
  shuffle(shuffled, 5);
  const std::vector<Reference> ordered = morton_order(shuffled, {}).references;
  EXPECT_EQ(ordered, morton_order(references, {}).references);
  for (size_t i = 1; i < ordered.size(); ++i) {
    const auto key = [&](size_t k) {
      return std::make_tuple(ordered[k].geometry, ordered[k].primitive, ordered[k].lower.x);
    };
    ASSERT_LT(key(i - 1), key(i));
  }
}

}  // namespace
}  // namespace kerf::test
