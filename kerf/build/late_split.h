#pragma once

#include "kerf/base/work_limit.h"
#include "kerf/references/clipper.h"
#include "kerf/references/early_split.h"
#include "kerf/tree/late_split_bvh.h"

namespace kerf {

/// Late split clipping (Ernst and Greiner: Early Split Clipping for Bounding Volume Hierarchies, 2007, section 5.1):
/// every leaf of a finished tree is cut in the middle of its longest side, and so are the parts, until their surface
/// area is at most options.sa_max. The tree must have one primitive in each leaf. options.cap counts pieces for each
/// leaf of the tree, on average; where sa_max would need more, it is raised until they fit. No path becomes longer than
/// kMaxDepth: pieces at that depth stay as they are. Parallel; the outcome does not depend on the number of threads.
/// Throws Error(invalid_option) as early_split() does, Error(stopped) at the limit.
LateSplitBvh build_late_split(const Bvh& bvh, const Clipper& clipper, const EarlySplit& options,
                              const WorkLimit& limit = {});

}  // namespace kerf
