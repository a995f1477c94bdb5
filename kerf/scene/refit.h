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

  /// Throws Error(invalid_argument) unless `moved` has the same kinds and counts as `built`, Error(invalid_geometry)
  /// for primitives in the tree that are invalid now: the first and how many.
  void check(std::span<const Geometry> built, std::span<const Geometry> moved) const;

  /// Makes the boxes of the structure, which was made from the tree, anew around its geometries; returns the root's.
  Box3f refit(Structure& structure);

  const RefitReport& report() const { return report_; }

 private:
  Fragments fragments_;
  std::vector<PrimitiveNumber> dropped_;
  RefitReport report_;
};

}  // namespace kerf
