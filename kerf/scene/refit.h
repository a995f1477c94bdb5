#pragma once

#include <memory>
#include <span>
#include <vector>

#include "kerf/references/reference.h"
#include "kerf/scene/structure.h"

namespace kerf {

/// What a refit did, and what the tree is worth now.
struct RefitReport {
  double sah_cost = 0;          ///< of the tree as it is now, see sah_cost()
  double built_sah_cost = 0;    ///< of the same tree as it was built
  double growth = 1;            ///< what it has become worse by since: see docs/refit.md
  bool should_rebuild = false;  ///< growth is above kRebuildGrowth
  size_t left_out =
      0;  ///< primitives that skip_invalid dropped from the build: they stay out until the next, moved or not
  size_t bytes = 0;  ///< that the scene keeps for refits, over BuildReport::bytes
  double seconds = 0;
};

/// Above it, a tree built anew is faster by more than refits leave to chance; measured in docs/refit.md.
inline constexpr double kRebuildGrowth = 1.5;

/// What a scene keeps so that its tree can follow vertices that move.
class RestPose {
 public:
  /// Of a finished tree, repeats marked, over the geometries at rest. `dropped`: see find_invalid().
  RestPose(const Bvh& bvh, std::span<const Geometry> geometries, std::vector<PrimitiveNumber> dropped);

  /// Puts `moved` in the place of `built`, which the structure made from the tree looks at, and makes its boxes anew
  /// around it; returns the root's. Throws Error(invalid_argument) unless there are the same kinds and counts, and
  /// Error(invalid_geometry) for primitives in the tree that are invalid now, the first and how many; then all is as
  /// before.
  Box3f refit(Structure& structure, std::span<Geometry> built, std::span<const Geometry> moved);

  const RefitReport& report() const { return report_; }

 private:
  void check(std::span<const Geometry> built, std::span<const Geometry> moved) const;

  Fragments fragments_;
  std::vector<PrimitiveNumber> dropped_;
  RefitOutcome built_;
  RefitReport report_;
};

}  // namespace kerf
