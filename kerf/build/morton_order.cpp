#include "kerf/build/morton_order.h"

#include <algorithm>
#include <tuple>

#include "kerf/base/parallel.h"
#include "kerf/base/radix_sort.h"
#include "kerf/references/box_around.h"

namespace kerf {
namespace {

constexpr size_t kGrain = 16384;

/// The box around all lower + upper, twice the centres.
Box3f bounds_of_centers(const std::vector<Reference>& references) {
  return box_around(references, [](Box3f& box, const Reference& r) { box.extend(r.lower + r.upper); });
}

/// The 21 low bits, each followed by two zeros.
uint64_t spread(uint64_t x) {
  x = (x | x << 32) & 0x001F00000000FFFFU;
  x = (x | x << 16) & 0x001F0000FF0000FFU;
  x = (x | x << 8) & 0x100F00F00F00F00FU;
  x = (x | x << 4) & 0x10C30C30C30C30C3U;
  return (x | x << 2) & 0x1249249249249249U;
}

bool comes_first(const Reference& a, const Reference& b) {
  const auto key = [](const Reference& r) {
    return std::tie(r.geometry, r.primitive, r.lower.x, r.lower.y, r.lower.z, r.upper.x, r.upper.y, r.upper.z);
  };
  return key(a) < key(b);
}

/// Orders the stretches of equal codes that begin in [begin, end).
void order_equal_codes(MortonOrder& order, size_t begin, size_t end) {
  const std::vector<uint64_t>& codes = order.codes;
  size_t first = begin;
  while (first < end && first > 0 && codes[first] == codes[first - 1]) ++first;  // of a stretch that began before
  while (first < end) {
    size_t last = first + 1;
    while (last < codes.size() && codes[last] == codes[first]) ++last;
    const auto all = order.references.begin();
    std::sort(all + static_cast<ptrdiff_t>(first), all + static_cast<ptrdiff_t>(last), comes_first);
    first = last;
  }
}

}  // namespace

MortonGrid::MortonGrid(const Box3f& centers) : first_(to_double(centers.lower)), axes_{kX, kY, kZ} {
  const Vec3d extent = to_double(centers.upper) - first_;
  std::stable_sort(axes_, axes_ + 3, [&](uint32_t a, uint32_t b) { return extent[a] > extent[b]; });
  const double longest = extent[axes_[0]];
  if (longest > 0) scale_ = static_cast<double>(uint32_t{1} << kMortonBits) / longest;
}

uint64_t MortonGrid::code(const Reference& reference) const {
  constexpr uint64_t kLastCell = (uint64_t{1} << kMortonBits) - 1;
  const Vec3f center2 = reference.lower + reference.upper;
  uint64_t code = 0;
  for (const uint32_t axis : axes_) {
    const auto cell = static_cast<uint64_t>((static_cast<double>(center2[axis]) - first_[axis]) * scale_);
    code = code << 1 | spread(std::min(cell, kLastCell));
  }
  return code;
}

MortonOrder morton_order(std::vector<Reference> references, const WorkLimit& limit) {
  const size_t count = references.size();
  // Given and ordered references, keys and codes; the copy that the sort makes is gone before the last.
  const HeldBytes held(count * (2 * sizeof(Reference) + sizeof(KeyedNumber) + sizeof(uint64_t)));
  std::vector<KeyedNumber> keys(count);
  const MortonGrid grid(bounds_of_centers(references));
  parallel_for(count, kGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) keys[i] = {grid.code(references[i]), static_cast<uint32_t>(i)};
  });
  limit.check();
  radix_sort(keys);
  limit.check();
  MortonOrder order{std::vector<Reference>(count), std::vector<uint64_t>(count)};
  parallel_for(count, kGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      order.references[i] = references[keys[i].number];
      order.codes[i] = keys[i].key;
    }
  });
  parallel_for(count, kGrain, [&](size_t begin, size_t end) { order_equal_codes(order, begin, end); });
  return order;
}

}  // namespace kerf
