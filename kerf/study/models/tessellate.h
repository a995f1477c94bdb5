#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "kerf/base/vec3.h"
#include "kerf/io/mesh.h"

namespace kerf {

/// A face of a CAD part: a smooth map of the unit square to space, counter-clockwise seen from outside; it bends by one
/// full turn at most. A side of the square may fall on one point (a pole), and two sides on one curve (a seam).
using Surface = std::function<Vec3d(double u, double v)>;

/// How finely faces are cut into triangles.
struct Fineness {
  double max_edge = std::numeric_limits<double>::infinity();  ///< no edge of a triangle is longer
  /// About how far grid lines may lie from the surface: what is straight gets few segments, what is bent as many as it
  /// needs.
  double chord = std::numeric_limits<double>::infinity();
};

/// The regular tessellator of Ernst and Greiner, "Early Split Clipping for Bounding Volume Hierarchies" (2007), section
/// 4: each face becomes a grid of quads, cut in two all the same way, with a chosen largest edge.
///
/// Sides that are the same curve, run through at the same pace in either direction, are one edge of the part and get
/// one subdivision, and so do the two opposite sides of a face. So what is joined in the part is joined in its
/// triangles, and no T-junction opens. Faces whose sides touch only in part are not joined.
class Tessellator {
 public:
  /// Throws Error (invalid_geometry) with the face as place where a surface is not finite.
  explicit Tessellator(std::vector<Surface> faces);

  size_t face_count() const { return faces_.size(); }

  /// How many triangles mesh() makes, give or take one per cent, without making them.
  uint64_t count(const Fineness& fineness) const;

  /// Makes the triangles. Throws Error (too_large) for more than 2^31 - 1, Error (invalid_option) for a fineness that
  /// is not positive, and Error (invalid_geometry) for a face so uneven that its edges cannot be kept short.
  Mesh mesh(const Fineness& fineness) const;

 private:
  static constexpr uint32_t kSides = 4;     // v = 0, u = 1, v = 1, u = 0, each run through with its parameter
  static constexpr uint32_t kSamples = 12;  // of a face each way, to judge its size and how it bends
  static constexpr uint32_t kNone = 0xFFFFFFFFU;

  /// A curve where faces meet, or where one ends.
  struct Edge {
    uint32_t face, side;         // whose points it has
    uint32_t begin, end;         // corners
    uint32_t direction = kNone;  // the entry of a plan that says how often it is cut
    bool is_point = false;
  };
  struct Use {
    uint32_t edge = 0;
    bool reversed = false;
  };
  struct Face {
    Surface surface;
    std::array<Use, kSides> sides;
    std::array<uint32_t, 4> corners{};           // at (0, 0), (1, 0), (1, 1), (0, 1)
    std::array<uint32_t, 2> directions{};        // entries of a plan: the segments along u and along v
    std::array<double, 2> bend{};                // the largest distance from its chord, of a line over the whole square
    std::vector<std::array<Vec3d, 2>> tangents;  // by u and by v, at the samples
    bool falling = false;                        // quads are cut from (1, 0) to (0, 1), else from (0, 0) to (1, 1)
  };
  using Plan = std::vector<uint32_t>;  // the segments of each direction
  struct Layout;

  void survey(size_t number);
  void measure_bend(Face& face, const std::vector<Vec3d>& points) const;
  void join_corners();
  void join_sides();
  void join_directions();
  Vec3d side_point(const Edge& edge, double t) const;
  bool is_same_curve(const Edge& a, const Edge& b, bool reversed) const;

  Plan plan(const Fineness& fineness) const;
  bool cut_long_edges(const Face& face, double max_edge, Plan& plan) const;
  uint64_t triangles_of(const Face& face, const Plan& plan) const;
  Mesh mesh_of(const Plan& plan) const;
  void fill_face(const Layout& layout, const Plan& plan, size_t number, Mesh& mesh) const;
  uint32_t vertex_on_side(const Layout& layout, const Plan& plan, const Face& face, uint32_t side, uint32_t k) const;

  std::vector<Face> faces_;
  std::vector<Edge> edges_;
  std::vector<Vec3d> corners_;
  Plan least_;  // segments that each direction has at least
  double tolerance_ = 0;
};

}  // namespace kerf
