#pragma once

#include <vector>

#include "kerf/base/options.h"
#include "kerf/base/work_limit.h"
#include "kerf/build/kd_plane.h"
#include "kerf/references/clipper.h"
#include "kerf/tree/kd_tree.h"

namespace kerf {

/// How a kd-tree is built.
struct KdOptions {
  bool is_sampled = false;  ///< planes by counting at samples; else at every event
  bool tries = true;        ///< halve cells that no plane improves, and keep that where the subtree pays
  bool clips = true;        ///< cut primitives at planes (Algorithm 3); else their boxes (Algorithm 1)
  KdCosts costs;
  uint32_t leaf_size = 1;  ///< so many references are not divided further
  uint32_t max_depth = 0;  ///< 0: 8 + 1.3 log2 of the number of references
  double cap = 32;         ///< references in the tree for each one given, at most
  uint32_t samples = 16;   ///< in each of two passes
};

/// The work of a build, the same for any number of threads.
struct KdWork {
  size_t events = 0;  ///< swept over
  size_t cuts = 0;    ///< references cut at a plane
};

/// Builds a kd-tree from the top by the surface area heuristic with split clipping (Havran and Bittner: On improving
/// kd-trees for ray shooting, 2002). A cell whose share of the references allowed would not do for its halves becomes a
/// leaf, so nothing is dropped. The same tree for any number of threads. Throws Error(stopped) at the limit,
/// Error(too_large) above 2^30 references, nodes or slots.
KdTree build_kd_tree(std::vector<Reference> references, const Clipper& clipper, const KdOptions& options,
                     const WorkLimit& limit = {}, KdWork* work = nullptr);

}  // namespace kerf
