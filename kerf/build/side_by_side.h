#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "kerf/base/parallel.h"
#include "kerf/build/top_down.h"
#include "kerf/references/box4.h"

namespace kerf::detail {

/// The box around references and that around their lower + upper.
struct Measure {
  Box4 bounds, centers;

  void clear() { bounds = centers = Box4::empty(); }
  void add(const Box4& reference) {
    bounds.extend(reference);
    const Float4 center2 = reference.lower + reference.upper;
    centers.extend({center2, center2});
  }
  void add(const Measure& other) {
    bounds.extend(other.bounds);
    centers.extend(other.centers);
  }
  Subset subset(uint32_t begin, uint32_t end) const { return {begin, end, bounds.box(), centers.box()}; }
};

inline constexpr uint32_t kMeasureGrain = 32768;  // references that one task looks at

inline Measure measure(std::span<const Reference> references) {
  Measure measure;
  measure.clear();
  for (const Reference& r : references) measure.add(Box4::of(r));
  return measure;
}

/// The subset of these references. Parallel if they are many.
inline Subset measured(std::span<const Reference> references, uint32_t begin, uint32_t end) {
  const std::span<const Reference> some = references.subspan(begin, end - begin);
  if (some.size() < 2 * kMeasureGrain) return measure(some).subset(begin, end);
  std::vector<Measure> blocks((some.size() + kMeasureGrain - 1) / kMeasureGrain);
  parallel_for(some.size(), kMeasureGrain, [&](size_t first, size_t last) {
    blocks[first / kMeasureGrain] = measure(some.subspan(first, last - first));
  });
  for (const Measure& block : blocks) blocks[0].add(block);
  return blocks[0].subset(begin, end);
}

/// References that are put in order at a time: a few pages, that stay in the nearest cache.
inline constexpr uint32_t kPartGrain = 512;

/// Puts those of a part for which goes_left() holds first; returns how many. Without a branch on what no processor can
/// foresee: each is written to where it would be on either side.
template <class F>
uint32_t put_part(std::span<Reference> part, const F& goes_left, Measure (&sides)[2]) {
  alignas(Reference) std::array<std::byte, kPartGrain * sizeof(Reference)> memory;
  auto* const right = reinterpret_cast<Reference*>(memory.data());
  size_t left_count = 0, right_count = 0;
  for (const Reference& reference : part) {
    const Reference moved = reference;
    const size_t is_right = goes_left(moved) ? 0 : 1;
    sides[is_right].add(Box4::of(moved));
    part[left_count] = moved;
    right[right_count] = moved;
    left_count += 1 - is_right;
    right_count += is_right;
  }
  std::copy_n(right, right_count, part.begin() + static_cast<ptrdiff_t>(left_count));
  return static_cast<uint32_t>(left_count);
}

/// Exchanges those on the wrong side of where all parts together are divided, in stretches.
inline void join_parts(std::span<Reference> all, const std::vector<uint32_t>& left_counts, size_t middle) {
  struct Stretch {
    size_t part = 0, begin = 0, end = 0;
  };
  const size_t last = left_counts.size();
  // The next stretch of those that stand before the middle and belong behind it, and the other way round.
  const auto next_right = [&](Stretch& s) {
    for (; s.begin == s.end && s.part < last; ++s.part) {
      const size_t first = s.part * kPartGrain;
      s.begin = std::min(middle, first + left_counts[s.part]);
      s.end = std::min({middle, first + kPartGrain, all.size()});
    }
  };
  const auto next_left = [&](Stretch& s) {
    for (; s.begin == s.end && s.part < last; ++s.part) {
      const size_t first = s.part * kPartGrain;
      s.begin = std::max(middle, first);
      s.end = std::max(middle, first + left_counts[s.part]);
    }
  };
  Stretch right, left;
  for (next_right(right), next_left(left); right.begin < right.end; next_right(right), next_left(left)) {
    const size_t count = std::min(right.end - right.begin, left.end - left.begin);
    std::swap_ranges(all.begin() + right.begin, all.begin() + right.begin + count, all.begin() + left.begin);
    right.begin += count;
    left.begin += count;
  }
}

/// Puts those of a subset for which goes_left() holds first. Parallel for large ones; the order does not depend on the
/// number of threads.
template <class F>
Halves put_side_by_side(std::span<Reference> references, const Subset& subset, const F& goes_left) {
  const std::span<Reference> all = references.subspan(subset.begin, subset.count());
  struct Sides {
    Measure of[2];
  };
  Sides sides;
  for (Measure& side : sides.of) side.clear();
  size_t left_count = 0;
  if (all.size() <= kPartGrain) {
    left_count = put_part(all, goes_left, sides.of);
  } else {
    std::vector<uint32_t> left_counts((all.size() + kPartGrain - 1) / kPartGrain);
    const auto put_some = [&](size_t begin, size_t end, Sides& to) {
      for (size_t first = begin; first < end; first += kPartGrain) {
        const size_t count = std::min<size_t>(kPartGrain, end - first);
        left_counts[first / kPartGrain] = put_part(all.subspan(first, count), goes_left, to.of);
      }
    };
    if (all.size() < 2 * kMeasureGrain) {
      put_some(0, all.size(), sides);
    } else {
      std::vector<Sides> blocks((all.size() + kMeasureGrain - 1) / kMeasureGrain, sides);
      parallel_for(all.size(), kMeasureGrain,
                   [&](size_t begin, size_t end) { put_some(begin, end, blocks[begin / kMeasureGrain]); });
      for (const Sides& block : blocks) {
        for (uint32_t side = 0; side < 2; ++side) sides.of[side].add(block.of[side]);
      }
    }
    for (const uint32_t count : left_counts) left_count += count;
    join_parts(all, left_counts, left_count);
  }
  const auto middle = subset.begin + static_cast<uint32_t>(left_count);
  return {sides.of[0].subset(subset.begin, middle), sides.of[1].subset(middle, subset.end)};
}

}  // namespace kerf::detail
