#pragma once

#include <array>
#include <limits>
#include <vector>

#include "kerf/base/work_limit.h"
#include "kerf/references/split_result.h"

namespace kerf {

/// How far to refine. See refine().
struct Refinement {
  enum class Measure : uint32_t {
    edge,  ///< the length of a side, in scene units
    area,  ///< of a triangle or parallelogram, in squared scene units
  };

  Measure measure = Measure::edge;
  double limit = std::numeric_limits<double>::infinity();  ///< what is larger is cut; infinite: nothing is
  /// At most this many pieces for each primitive on average, at least 1. Where the limit would need more, it is raised
  /// until the count fits.
  double cap = 16;

  /// As finely as a total of `budget` pieces per primitive allows.
  static Refinement with_budget(double budget, Measure measure = Measure::edge) {
    return {measure, std::numeric_limits<double>::min(), budget};
  }
};

/// Geometry refinement (Ernst and Greiner: Early Split Clipping for Bounding Volume Hierarchies, 2007, section 4): one
/// reference for each of the small triangles that refine_mesh() would make, with its box, rounded outward; together the
/// small triangles cover the original. Only a tree's boxes are refined: rays are tested against the original primitive,
/// so hits tell its number and barycentrics, the same bits as with any other structure. A parallelogram is cut into
/// equal ones, halved along both sides until they are short enough, or one-to-four until they are small enough; spheres
/// stay whole.
///
/// Takes and gives references in the caller's order, pieces of one primitive side by side. Parallel; the outcome does
/// not depend on the number of threads. Throws Error(invalid_option) if the limit is not above 0 or the cap is not at
/// least 1 (NaN included), Error(stopped) at the work's limit.
SplitResult refine(std::span<const Geometry> geometries, std::span<const Reference> whole, const Refinement& options,
                   const WorkLimit& limit = {});

/// A mesh of small triangles.
struct RefinedMesh {
  /// The weights of the original triangle's second and third corner, as in Hit.
  struct Weights {
    float u = 0, v = 0;
    friend bool operator==(const Weights&, const Weights&) = default;
  };

  std::vector<Vec3f> vertices;  ///< equal places of the original mesh have become one vertex
  std::vector<TriangleCorners> triangles;
  std::vector<uint32_t> originals;              ///< which triangle each one is part of
  std::vector<std::array<Weights, 3>> weights;  ///< where its corners lie in that triangle
  double limit = 0;                             ///< that was used
  bool capped = false;                          ///< true: the limit asked for would have passed the cap

  /// Of what a mesh needs to be traced: vertices and triangles.
  size_t bytes() const { return vertices.size() * sizeof(Vec3f) + triangles.size() * sizeof(TriangleCorners); }
};

/// The same refinement as geometry. A side is halved until it is at most the limit, be it cut from the left or from the
/// right; with an area limit as often as the larger of the triangles at it needs to be cut one-to-four. So no
/// T-junction opens: a closed mesh stays closed, though rounding of new vertices to float may move them off the
/// original's plane. Triangles without area take part, for others may lie at them. Throws as refine() does, and
/// Error(invalid_geometry) for a triangle that is not finite or has a bad index.
RefinedMesh refine_mesh(const TriangleMesh& mesh, const Refinement& options);

}  // namespace kerf
