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

/// What came of a block of references: the pieces of those that were cut, in order; the others stand where they stood.
struct SplitBlock {
  struct Cut {
    uint32_t place;   ///< in the block
    uint32_t pieces;  ///< how many
  };
  std::vector<Reference> pieces;
  std::vector<Cut> cuts;

  size_t bytes() const { return pieces.size() * sizeof(Reference) + cuts.size() * sizeof(Cut); }
  size_t count(size_t whole) const { return whole - cuts.size() + pieces.size(); }
  /// All references of the block, from `out` on.
  void gather(std::span<const Reference> whole, Reference* out) const {
    const Reference* piece = pieces.data();
    size_t done = 0;
    for (const Cut& cut : cuts) {
      out = std::copy(whole.begin() + static_cast<ptrdiff_t>(done), whole.begin() + cut.place, out);
      out = std::copy_n(piece, cut.pieces, out);
      piece += cut.pieces;
      done = cut.place + 1;
    }
    std::copy(whole.begin() + static_cast<ptrdiff_t>(done), whole.end(), out);
  }
};

/// Calls split(reference, emit) for each reference, in blocks at once; split calls emit(piece) for each piece, which
/// returns false to stop early. The pieces in order, or nothing if they are more than `most`. For progress it is half
/// of what is left, for another try may follow. Throws Error(stopped) at the limit.
template <class Split>
std::optional<std::vector<Reference>> split_each(std::span<const Reference> whole, size_t most, const WorkLimit& limit,
                                                 Split&& split) {
  constexpr size_t kTellEvery = 256;
  const auto of_block = [&](size_t b) {
    const size_t begin = b * kSplitGrain;
    return whole.subspan(begin, std::min(kSplitGrain, whole.size() - begin));
  };
  std::vector<SplitBlock> blocks((whole.size() + kSplitGrain - 1) / kSplitGrain);
  std::atomic<size_t> total = whole.size();
  const ProgressPart part(limit, 0.5);
  limit.plan(static_cast<double>(whole.size()));
  HeldBytes held;
  parallel_for(blocks.size(), 1, [&](size_t b, size_t) {
    const std::span<const Reference> some = of_block(b);
    SplitBlock block;
    size_t told = 0, told_count = some.size();
    // Told to the others now and then, or each thread might make as many as all together may. Never more than there
    // will be in the end: a reference that is being cut does not count besides its pieces.
    const auto tell = [&](bool is_cutting) {
      held.add(block.bytes() - std::exchange(told, block.bytes()));
      const size_t count = block.count(some.size()) - (is_cutting ? 1 : 0);
      limit.check((total += count - std::exchange(told_count, count)) * sizeof(Reference));
    };
    for (uint32_t i = 0; i < some.size() && total.load(std::memory_order_relaxed) <= most; ++i) {
      const size_t before = block.pieces.size();
      split(some[i], [&](const Reference& piece) {
        block.pieces.push_back(piece);
        if (block.pieces.size() % kTellEvery == 0) tell(true);
        return total.load(std::memory_order_relaxed) <= most;
      });
      const auto pieces = static_cast<uint32_t>(block.pieces.size() - before);
      if (pieces == 1 && block.pieces.back() == some[i]) {
        block.pieces.pop_back();
      } else {
        block.cuts.push_back({i, pieces});
      }
    }
    tell(false);
    blocks[b] = block;  // a copy is as long as it has to be
    limit.advance(static_cast<double>(some.size()));
  });
  if (total > most) return std::nullopt;
  std::vector<size_t> begins(blocks.size());
  size_t begin = 0;
  for (size_t b = 0; b < blocks.size(); ++b) {
    begins[b] = begin;
    begin += blocks[b].count(of_block(b).size());
  }
  held.add(begin * sizeof(Reference));
  std::vector<Reference> all(begin);
  parallel_for(blocks.size(), 16, [&](size_t first, size_t last) {
    for (size_t b = first; b < last; ++b) blocks[b].gather(of_block(b), all.data() + begins[b]);
  });
  return all;
}

}  // namespace kerf
