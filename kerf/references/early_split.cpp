#include "kerf/references/early_split.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "kerf/base/error.h"
#include "kerf/base/parallel.h"

namespace kerf {
namespace {

constexpr size_t kGrain = 1024;
constexpr size_t kTellEvery = 256;

Reference with_box(Reference reference, const Box3f& box) {
  reference.lower = box.lower;
  reference.upper = box.upper;
  return reference;
}

/// Algorithm 4 for one primitive; emit(reference) returns false to stop early.
template <class Emit>
void split_primitive(const Reference& whole, const Clipper& clipper, double sa_max, std::vector<Reference>& stack,
                     Emit&& emit) {
  stack.assign(1, whole);
  while (!stack.empty()) {
    const Reference top = stack.back();
    stack.pop_back();
    const Box3f box = top.bounds();
    const uint32_t axis = largest_axis(box.extent());
    const float middle = center(box, axis);
    const bool can_cut = box.lower[axis] < middle && middle < box.upper[axis];
    if (surface_area(box) <= sa_max || !can_cut) {
      if (!emit(top)) return;
      continue;
    }
    const ClippedBoxes parts = clipper(top, axis, middle);
    if (parts.below.is_empty() && parts.above.is_empty()) {  // only rounding can do that: keep what we had
      if (!emit(top)) return;
      continue;
    }
    if (!parts.above.is_empty()) stack.push_back(with_box(top, parts.above));
    if (!parts.below.is_empty()) stack.push_back(with_box(top, parts.below));
  }
}

/// The references that sa_max gives, or nothing if they are more than `most`.
std::optional<std::vector<Reference>> split_all(std::span<const Reference> whole, const Clipper& clipper, double sa_max,
                                                size_t most) {
  std::vector<std::vector<Reference>> blocks((whole.size() + kGrain - 1) / kGrain);
  std::atomic<size_t> total = 0;
  parallel_for(whole.size(), kGrain, [&](size_t begin, size_t end) {
    std::vector<Reference>& out = blocks[begin / kGrain];
    std::vector<Reference> stack;
    size_t told = 0;  // pieces of `out` that `total` knows of
    for (size_t i = begin; i < end && total.load(std::memory_order_relaxed) <= most; ++i) {
      split_primitive(whole[i], clipper, sa_max, stack, [&](const Reference& piece) {
        out.push_back(piece);
        // Told to the others now and then, or each thread might make as many as all together may.
        if (out.size() - told >= kTellEvery) total += out.size() - std::exchange(told, out.size());
        return total.load(std::memory_order_relaxed) <= most;
      });
    }
    total += out.size() - told;
  });
  if (total > most) return std::nullopt;
  std::vector<Reference> all;
  all.reserve(total);
  for (std::vector<Reference>& block : blocks) {
    all.insert(all.end(), block.begin(), block.end());
    std::vector<Reference>().swap(block);
  }
  return all;
}

/// Splits with the smallest sa_max, to 0.05 %, above `too_small` whose references fit. The count never grows with
/// sa_max, because a piece lies within the box that it was cut from; so bisection finds it, on a logarithmic scale. A
/// finer limit only cuts the pieces of a coarser one further, so each step starts from the finest pieces that fitted;
/// the way down in large steps comes first, as few primitives are cut there.
EarlySplitResult split_to_fit(std::span<const Reference> whole, const Clipper& clipper, double too_small, size_t most) {
  EarlySplitResult result{{whole.begin(), whole.end()}, 0, true};
  for (const Reference& reference : whole) result.sa_max = std::max(result.sa_max, surface_area(reference.bounds()));
  bool found_too_small = false;
  const auto enough = [&] {
    return static_cast<double>(result.references.size()) >= 0.999 * static_cast<double>(most);
  };
  while (result.sa_max > too_small * 1.0005 && !enough()) {
    found_too_small = found_too_small || result.sa_max / 8 <= too_small;
    const double middle = found_too_small ? std::sqrt(result.sa_max) * std::sqrt(too_small) : result.sa_max / 8;
    if (!(too_small < middle && middle < result.sa_max)) break;
    if (auto finer = split_all(result.references, clipper, middle, most)) {
      result.references = std::move(*finer);
      result.sa_max = middle;
    } else {
      too_small = middle;
      found_too_small = true;
    }
  }
  return result;
}

}  // namespace

EarlySplitResult early_split(std::span<const Reference> whole, const Clipper& clipper, const EarlySplit& options) {
  if (!(options.sa_max > 0)) {
    throw Error(ErrorCode::invalid_option, "early_split",
                "sa_max is " + std::to_string(options.sa_max) + "; it must be above 0 (inf: no splitting)");
  }
  if (!(options.cap >= 1)) {
    throw Error(ErrorCode::invalid_option, "early_split",
                "cap is " + std::to_string(options.cap) + "; it must be at least 1 reference per primitive");
  }
  if (std::isinf(options.sa_max)) return {{whole.begin(), whole.end()}, options.sa_max, false};
  const double allowed = std::floor(options.cap * static_cast<double>(whole.size()));
  const auto most = static_cast<size_t>(std::min(static_cast<double>(kMaxReferences), allowed));
  if (auto references = split_all(whole, clipper, options.sa_max, most)) {
    return {std::move(*references), options.sa_max, false};
  }
  return split_to_fit(whole, clipper, options.sa_max, most);
}

}  // namespace kerf
