#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "kerf/references/reference.h"
#include "kerf/tree/bsp_tree.h"

namespace kerf {

/// The part of a primitive in a cell: a convex polygon, or of a sphere a box around that part of its surface.
struct BspPiece {
  Box3f bounds;
  uint32_t reference = 0;  ///< the number of the primitive's reference
  uint32_t first = 0;      ///< its corners in BspPieces::corners
  uint32_t count = 0;      ///< of corners; 0: a sphere
  float area = 0;          ///< of the polygon
  bool is_flush = false;   ///< it lies in a plane that was cut along, so its own would divide nothing
};

/// The pieces in one cell, and how planes cut them. Every point of a primitive stays within rounding, some 2^-52 of
/// the largest coordinate for each cut, of one of its pieces, and that within `tolerance` of its side of each plane:
/// both sides of a cut share the same new corners, so nothing opens between them.
class BspPieces {
 public:
  BspPieces(std::span<const Geometry> geometries, const std::vector<Reference>& references, double tolerance)
      : geometries_(geometries), references_(&references), tolerance_(tolerance) {}

  /// Adds the piece that is the whole primitive of reference `number`.
  void add_whole(uint32_t number);

  const std::vector<BspPiece>& list() const { return list_; }
  uint32_t size() const { return static_cast<uint32_t>(list_.size()); }
  size_t bytes() const { return list_.capacity() * sizeof(BspPiece) + corners_.capacity() * sizeof(Vec3d); }
  const Reference& reference_of(const BspPiece& piece) const { return (*references_)[piece.reference]; }
  Box3f bounds() const;

  /// The plane of a polygon's primitive; nothing for a sphere, or where the normal is lost to rounding.
  std::optional<BspPlane> plane_of(const BspPiece& piece) const;

  /// How many pieces a cut gives to either side.
  struct Counts {
    uint32_t below = 0, above = 0;
  };
  Counts count(const BspPlane& plane) const;
  Counts count_across(uint32_t axis, float position) const;

  /// A piece goes to the side where it lies, one that reaches both sides is cut, and one in the plane goes below.
  std::pair<BspPieces, BspPieces> cut(const BspPlane& plane) const;

 private:
  enum class Side { below, above, both, within };

  /// The least and largest distance above a plane.
  std::pair<double, double> extent(const BspPiece& piece, const BspPlane& plane) const;
  Side side_of(const BspPiece& piece, const BspPlane& plane) const;
  std::span<const Vec3d> corners_of(const BspPiece& piece) const {
    return {corners_.data() + piece.first, piece.count};
  }
  void add(BspPiece piece, std::span<const Vec3d> corners);
  void cut_polygon(const BspPiece& piece, const BspPlane& plane, BspPieces& below, BspPieces& above) const;
  void cut_sphere(const BspPiece& piece, const BspPlane& plane, BspPieces& below, BspPieces& above) const;

  std::span<const Geometry> geometries_;
  const std::vector<Reference>* references_;
  double tolerance_;
  std::vector<BspPiece> list_;
  std::vector<Vec3d> corners_;
};

}  // namespace kerf
