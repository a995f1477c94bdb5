#pragma once

#include <memory>
#include <span>
#include <vector>

#include "kerf/references/reference.h"
#include "kerf/scene/structure.h"

namespace kerf {

/// What a refit did, and what the tree is worth now.
struct RefitReport {
  /// How much more work rays are in this tree than in one built anew for the vertices as they are, estimated; 1 after a
  /// build. docs/refit.md says how, and how far it can be trusted.
  double growth = 1;
  bool should_rebuild = false;  ///< growth is above kRebuildGrowth, or something is left out
  double sah_cost = 0;          ///< of the tree as it is now, see sah_cost()
  double built_sah_cost = 0;    ///< of the same tree as it was built
  /// Primitives that the build left out for good, because they were invalid (skip_invalid) or had a vertex twice, and
  /// that are fine by now: only a build brings them in.
  size_t left_out = 0;
  size_t bytes = 0;  ///< that the scene keeps for refits, besides BuildReport::bytes
  double seconds = 0;
};

/// Above it, building anew pays where more than a few frames are to come; see docs/refit.md.
inline constexpr double kRebuildGrowth = 1.4;

/// What a scene keeps so that its tree can follow vertices that move.
class RestPose {
 public:
  /// Of a finished tree, repeats marked, over the geometries at rest. `left_out`: see find_left_out();
  /// `primitives`: in the tree.
  RestPose(const Bvh& bvh, std::span<const Geometry> geometries, std::vector<PrimitiveNumber> left_out,
           size_t primitives);

  /// What the structure made from the tree costs and keeps for refits itself; once, before the first refit().
  void set_built(double sah_cost, size_t bytes);

  /// Puts `moved` in the place of `built`, which the structure made from the tree looks at, and makes its boxes anew
  /// around it; returns the root's. Throws Error(invalid_argument) unless there are the same kinds and counts, and
  /// Error(invalid_geometry) for primitives in the tree that are invalid now, the first and how many; then all is as
  /// before.
  Box3f refit(Structure& structure, std::span<Geometry> built, std::span<const Geometry> moved);

  const RefitReport& report() const { return report_; }

 private:
  void check(std::span<const Geometry> built, std::span<const Geometry> moved) const;

  Fragments fragments_;
  std::vector<PrimitiveNumber> left_out_;
  RefitOutcome built_;
  RefitReport report_;
};

}  // namespace kerf
