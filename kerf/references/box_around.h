#pragma once

#include <span>
#include <vector>

#include "kerf/base/parallel.h"
#include "kerf/references/reference.h"

namespace kerf {

/// The box around all references, or around what else extend(box, reference) adds of each. Parallel; boxes can be
/// joined in any order with the same outcome.
template <class Extend>
Box3f box_around(std::span<const Reference> references, Extend&& extend) {
  constexpr size_t kGrain = 16384;
  std::vector<Box3f> blocks((references.size() + kGrain - 1) / kGrain);
  parallel_for(references.size(), kGrain, [&](size_t begin, size_t end) {
    Box3f& box = blocks[begin / kGrain];
    for (const Reference& reference : references.subspan(begin, end - begin)) extend(box, reference);
  });
  Box3f all;
  for (const Box3f& block : blocks) all.extend(block);
  return all;
}
inline Box3f box_around(std::span<const Reference> references) {
  return box_around(references, [](Box3f& box, const Reference& reference) { box.extend(reference.bounds()); });
}

}  // namespace kerf
