#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "kerf/base/parallel.h"
#include "kerf/base/work_limit.h"
#include "kerf/references/reference.h"

namespace kerf {

/// How many references `cap` for each of `whole` are, and never more than a tree can hold.
inline size_t most_references(size_t whole, double cap) {
  const double allowed = std::floor(cap * static_cast<double>(whole));
  return static_cast<size_t>(std::min(static_cast<double>(kMaxReferences), allowed));
}

/// References that one task splits, one after another.
inline constexpr size_t kSplitGrain = 1024;

/// Calls split(reference, emit) for each reference, in blocks at once; split calls emit(piece) for each piece, which
/// returns false to stop early. The pieces in order, or nothing if they are more than `most`. For progress it is half
/// of what is left, for another try may follow. Throws Error(stopped) at the limit.
template <class Split>
std::optional<std::vector<Reference>> split_each(std::span<const Reference> whole, size_t most, const WorkLimit& limit,
                                                 Split&& split) {
  constexpr size_t kTellEvery = 256;
  std::vector<std::vector<Reference>> blocks((whole.size() + kSplitGrain - 1) / kSplitGrain);
  std::atomic<size_t> total = 0;
  const ProgressPart part(limit, 0.5);
  limit.plan(static_cast<double>(whole.size()));
  HeldBytes held;
  parallel_for(whole.size(), kSplitGrain, [&](size_t begin, size_t end) {
    std::vector<Reference>& out = blocks[begin / kSplitGrain];
    out.reserve(end - begin);
    size_t told = 0;  // pieces of `out` that `total` knows of
    // Told to the others now and then, or each thread might make as many as all together may.
    const auto tell = [&] {
      const size_t more = out.size() - std::exchange(told, out.size());
      held.add(more * sizeof(Reference));
      limit.check((total += more) * sizeof(Reference));
    };
    const auto emit = [&](const Reference& piece) {
      out.push_back(piece);
      if (out.size() - told >= kTellEvery) tell();
      return total.load(std::memory_order_relaxed) <= most;
    };
    for (size_t i = begin; i < end && total.load(std::memory_order_relaxed) <= most; ++i) split(whole[i], emit);
    tell();
    if (out.size() < out.capacity() / 4 * 3) out.shrink_to_fit();
    limit.advance(static_cast<double>(end - begin));
  });
  if (total > most) return std::nullopt;
  held.add(total * sizeof(Reference));  // in blocks and, as they are freed, in one
  std::vector<Reference> all;
  all.reserve(total);
  for (std::vector<Reference>& block : blocks) {
    all.insert(all.end(), block.begin(), block.end());
    std::vector<Reference>().swap(block);
  }
  return all;
}

}  // namespace kerf
