#pragma once

#include <vector>

#include "kerf/choose/splitters.h"

namespace kerf {

/// What automatic splitting may use.
struct AutomaticSplit {
  /// At most this many references for each primitive on average, at least 1; honoured for every scene.
  double cap = 2;
};

/// Early split clipping that chooses for itself, for each part of the scene, what to cut, where and how far: from
/// nothing where triangles are small and alike to twice the references where they are large and lie askew. The planes
/// are those that a coarse tree would cut at, found on a sample; see guide_splits(). References come in the caller's
/// order, pieces of one primitive side by side. Parallel; the outcome does not depend on the number of threads, and
/// but for rounding neither on the scene's scale. SplitResult::choice says how far it went and why. Where
/// SplitInput::most leaves less room than the cap, that counts. Throws Error(invalid_option) if cap is not at least 1,
/// Error(stopped) at the limit.
SplitResult split_automatically(const SplitInput& input, const AutomaticSplit& options = {});

/// For builders other than Kerf's: the boxes of a mesh's triangles, split as split_automatically() does, as
/// split_references(mesh, EarlySplit) gives them.
std::vector<Reference> split_references(const TriangleMesh& mesh, const AutomaticSplit& options,
                                        bool skip_invalid = false);

}  // namespace kerf
