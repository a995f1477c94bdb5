// What the tests of the wide layouts begin with and have in common.

#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "kerf/base/work_limit.h"
#include "kerf/build/builders.h"
#include "kerf/layout/wide_collapse.h"
#include "kerf/references/early_split.h"

namespace kerf::test {

/// The tree that lbvh makes, of twice as many references as primitives where they are to be split.
inline Bvh lbvh_tree(std::span<const Geometry> geometries, bool split = false) {
  std::vector<Reference> references = make_references(geometries).references;
  if (split) references = early_split(references, geometry_clipper(geometries), EarlySplit::with_budget(2)).references;
  const BuilderEntry& lbvh =
      *std::find_if(builders().begin(), builders().end(), [](const auto& entry) { return entry.name == "lbvh"; });
  Bvh bvh = lbvh.build({std::move(references), geometry_clipper(geometries)}, OptionValues(lbvh.options));
  mark_repeated(bvh, geometries);
  return bvh;
}

/// The most memory that is held while make() makes a wide layout of the tree, which must be the layout and the
/// collapse.
template <class Make>
size_t peak_of_making(const Bvh& bvh, Make&& make) {
  WorkMeter meter;
  WorkLimit limit;
  limit.meter = &meter;
  const LimitScope scope(&limit);
  const auto layout = make();
  EXPECT_EQ(meter.peak(), layout.bytes() + bvh.nodes.size() * WideCollapse::kBytesPerNode);
  return meter.peak();
}

}  // namespace kerf::test
