#include "kerf/references/early_split.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "kerf/base/error.h"
#include "kerf/base/thread_vector.h"
#include "kerf/references/fit_limit.h"
#include "kerf/references/middle_cut.h"
#include "kerf/references/split_each.h"

namespace kerf {
namespace {

/// Algorithm 4 for one primitive; emit(reference) returns false to stop early.
template <class Emit>
void split_primitive(const Reference& whole, const Clipper& clipper, double sa_max, std::vector<Reference>& stack,
                     Emit&& emit) {
  stack.assign(1, whole);
  while (!stack.empty()) {
    const Reference top = stack.back();
    stack.pop_back();
    const auto parts = surface_area(top.bounds()) > sa_max ? cut_in_the_middle(top, clipper) : std::nullopt;
    if (!parts) {
      if (!emit(top)) return;
      continue;
    }
    if (!parts->above.is_empty()) stack.push_back(with_box(top, parts->above));
    if (!parts->below.is_empty()) stack.push_back(with_box(top, parts->below));
  }
}

/// The references that sa_max gives, or nothing if they are more than `most`.
std::optional<std::vector<Reference>> split_all(std::span<const Reference> whole, const Clipper& clipper, double sa_max,
                                                size_t most, const WorkLimit& limit) {
  return split_each(whole, most, limit, [&](const Reference& reference, const auto& emit) {
    ThreadVector<Reference> stack;
    split_primitive(reference, clipper, sa_max, *stack, emit);
  });
}

/// Splits with the smallest sa_max, to 0.05 %, above `too_small` whose references fit. The count never grows with
/// sa_max, because a piece lies within the box that it was cut from; so bisection finds it. A finer limit only cuts the
/// pieces of a coarser one further, so each step starts from the finest pieces that fitted.
SplitResult split_to_fit(std::span<const Reference> whole, const Clipper& clipper, double too_small, size_t most,
                         const WorkLimit& limit) {
  SplitResult result{{whole.begin(), whole.end()}, 0, true};
  for (const Reference& reference : whole) result.limit = std::max(result.limit, surface_area(reference.bounds()));
  result.limit = lower_to_fit(result.limit, too_small, whole.size(), most, [&](double sa_max) -> std::optional<size_t> {
    const HeldBytes held(result.references.capacity() * sizeof(Reference));
    auto finer = split_all(result.references, clipper, sa_max, most, limit);
    if (!finer) return std::nullopt;
    result.references = std::move(*finer);
    return result.references.size();
  });
  return result;
}

}  // namespace

SplitResult early_split(std::span<const Reference> whole, const Clipper& clipper, const EarlySplit& options,
                        const WorkLimit& limit) {
  if (!(options.sa_max > 0)) {
    throw Error(ErrorCode::invalid_option, "early_split",
                "sa_max is " + std::to_string(options.sa_max) + "; it must be above 0 (inf: no splitting)");
  }
  if (!(options.cap >= 1)) {
    throw Error(ErrorCode::invalid_option, "early_split",
                "cap is " + std::to_string(options.cap) + "; it must be at least 1 reference per primitive");
  }
  limit.check(whole.size_bytes());
  if (std::isinf(options.sa_max)) return {{whole.begin(), whole.end()}, options.sa_max, false};
  const size_t most = most_references(whole.size(), options.cap);
  if (auto references = split_all(whole, clipper, options.sa_max, most, limit)) {
    return {std::move(*references), options.sa_max, false};
  }
  return split_to_fit(whole, clipper, options.sa_max, most, limit);
}

}  // namespace kerf
