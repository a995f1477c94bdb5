#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "kerf/tree/bsp_tree.h"

namespace kerf {

/// A convex polyhedron in double, for the surface area heuristic: what is left of a box after cuts by planes. Rounding
/// may dent it, so nothing but costs may depend on it.
class ConvexCell {
 public:
  ConvexCell() = default;
  explicit ConvexCell(const Box3f& box);

  double area() const { return area_; }

  /// The surface areas of the parts below and above a plane.
  struct Areas {
    double below = 0, above = 0;
  };
  Areas areas_after(const BspPlane& plane) const;

  struct Parts;
  Parts cut(const BspPlane& plane) const;

  /// Around all corners; lower above upper where there are none.
  std::pair<Vec3d, Vec3d> bounds() const;

 private:
  struct Face {
    uint32_t begin = 0, end = 0;  ///< its corners, in order around it
    double area = 0;
  };

  void close_face(uint32_t begin);

  std::vector<Vec3d> corners_;
  std::vector<Face> faces_;
  double area_ = 0;
};

struct ConvexCell::Parts {
  ConvexCell below, above;
};

/// Where the edge from p, below the plane, to q, above it, crosses: the same point for every face and polygon that has
/// the edge.
inline Vec3d crossing(Vec3d p, double p_side, Vec3d q, double q_side) {
  return p + (q - p) * (p_side / (p_side - q_side));
}

}  // namespace kerf
