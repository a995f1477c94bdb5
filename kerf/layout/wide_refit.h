#pragma once

#include "kerf/layout/quantised_bvh.h"
#include "kerf/layout/wide_bvh.h"
#include "kerf/layout/wide_collapse.h"
#include "kerf/tree/fragments.h"
#include "kerf/tree/refit_nodes.h"

namespace kerf {

/// Which slots of the Bvh each leaf of a layout made from it stands for: those that Fragments are of. Kept for refits
/// where some primitive has several references; without one nothing is asked by number.
struct LeafNumbers {
  static constexpr uint32_t kLast = 0x80000000U;

  std::vector<uint32_t> first;    ///< of the leaf that begins at unit u, by u / 2: where its numbers begin
  std::vector<uint32_t> numbers;  ///< for each slot of a leaf those that became it, the last of them marked with kLast

  size_t bytes() const { return (first.size() + numbers.size()) * sizeof(uint32_t); }
};

/// Of the layout that a collapse leads to.
LeafNumbers number_leaves(const Bvh& bvh, const WideCollapse& collapse);

/// Makes every box anew around what moved, and writes the moved triangles into the leaves. Parallel; the outcome does
/// not depend on the number of threads.
/// Layout: WideBvh<4>, WideBvh<8>, QuantisedBvh.
template <class Layout>
RefitOutcome refit(Layout& layout, const LeafNumbers& numbers, const Fragments& fragments,
                   std::span<const Geometry> geometries);

}  // namespace kerf
