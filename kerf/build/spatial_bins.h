#pragma once

#include <limits>
#include <span>

#include "kerf/references/clipper.h"

namespace kerf {

/// Planes at equal distances through a box, along each axis; slice i lies between planes i and i + 1.
class SpatialSlices {
 public:
  static constexpr uint32_t kMost = 32;

  struct Span {
    uint32_t first, last;
  };

  SpatialSlices(const Box3f& bounds, uint32_t count);

  uint32_t count() const { return count_; }
  /// False: no planes, for the box is flat here, or as good as.
  bool is_usable(uint32_t axis) const { return usable_[axis]; }
  /// No planes across this axis.
  void leave_out(uint32_t axis) { usable_[axis] = false; }
  /// Plane 0 and plane count() are the box's sides.
  float plane(uint32_t axis, uint32_t i) const { return planes_[axis][i]; }

  /// The slices that a reference within the box reaches into; a side that lies in a plane does not reach past it. So a
  /// reference with last < i lies below plane i, and of the others one with first >= i above it.
  Span span(const Reference& reference, uint32_t axis) const;

 private:
  uint32_t count_;
  Vec3f first_, scale_;
  bool usable_[3];
  float planes_[3][kMost + 1];
};

/// A plane to cut at, and what lies on its two sides then.
struct SpatialPlane {
  double cost = std::numeric_limits<double>::infinity();  ///< area times count, both sides added
  uint32_t axis = 0;
  float position = 0;
  double below_count = 0, above_count = 0;  ///< references across the plane count on both sides; 0: no plane
  Box3f below, above;                       ///< may be too large: cuts are guessed at

  bool is_found() const { return below_count > 0; }
  /// References on the two sides together.
  double both() const { return below_count + above_count; }
};

/// What a plane must keep to.
struct SpatialLimits {
  double both;    ///< references on the two sides together, at most
  double either;  ///< on one side, at most
  double cost;    ///< must be below
};

/// The plane between two slices with the least area times count, if references across it are cut there; nothing if none
/// within the limits has something on both sides. Each reference counts as many times as `weights` says, a whole
/// number; once if it is empty. Parallel for many references.
SpatialPlane cheapest_spatial_plane(std::span<const Reference> references, std::span<const float> weights,
                                    const SpatialSlices& slices, const Clipper& clipper, const SpatialLimits& limits);

}  // namespace kerf
