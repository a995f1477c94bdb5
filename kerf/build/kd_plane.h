#pragma once

#include <limits>

#include "kerf/base/box3.h"

namespace kerf {

/// The plane at which a cell is divided.
struct KdPlane {
  double cost = std::numeric_limits<double>::infinity();  ///< infinite: no plane
  uint32_t axis = 0;
  float position = 0;
  bool flat_go_below = false;  ///< the side of references that lie in the plane
};

/// What a ray through a cell costs (MacDonald and Booth 1990), with less for a plane that cuts off empty space.
struct KdCosts {
  double traversal = 1;
  double primitive = 1;
  double empty_bonus = 0.1;

  double leaf(size_t references) const { return primitive * static_cast<double>(references); }
};

/// The cost of planes across one axis of a cell, whose sides are linear in the plane's position.
class KdAxisCost {
 public:
  KdAxisCost(const KdCosts& costs, const Box3f& cell, uint32_t axis)
      : traversal_(costs.traversal), kept_(1 - costs.empty_bonus), lower_(cell.lower[axis]), upper_(cell.upper[axis]) {
    const Vec3d extent = to_double(cell.upper) - to_double(cell.lower);
    const double b = extent[(axis + 1) % 3], c = extent[(axis + 2) % 3];
    const double scale = costs.primitive / half_area(cell);
    end_ = b * c * scale;
    side_ = (b + c) * scale;
  }

  double operator()(double position, size_t below, size_t above) const {
    const double cost = traversal_ + static_cast<double>(below) * (end_ + side_ * (position - lower_)) +
                        static_cast<double>(above) * (end_ + side_ * (upper_ - position));
    return below == 0 || above == 0 ? kept_ * cost : cost;
  }

 private:
  double traversal_, kept_, lower_, upper_, end_, side_;
};

}  // namespace kerf
