#pragma once

#include <array>
#include <vector>

#include "kerf/base/transform.h"
#include "kerf/study/models/tessellate.h"

namespace kerf {

using Curve = std::function<Vec3d(double)>;
using Faces = std::vector<Surface>;

/// A point of a profile: how far from the axis and how high, and the radius by which the corner there is rounded.
struct ProfilePoint {
  double r, z, fillet = 0;
};

/// The lines and arcs of an open profile, in the plane y = 0.
std::vector<Curve> rounded_profile(const std::vector<ProfilePoint>& points);

/// A solid of revolution about the z axis of `place`. The profile goes up on the outside.
void add_revolved(Faces& faces, const std::vector<ProfilePoint>& profile, const Transform& place);

/// A cylinder without fillets about the z axis of `place`, from z = 0 on.
void add_cylinder(Faces& faces, double radius, double height, const Transform& place);

void add_box(Faces& faces, Vec3d low, Vec3d high);

/// A profile carried along a path, in `pieces` faces one after another, with ends if it is not a loop. The profile's
/// curves form a loop, counter-clockwise about (0, 0, 0) in the plane z = 0; its x axis stays at right angles to
/// `upright`, which the path must not follow. `scale` is a factor for each place of the path.
struct Sweep {
  std::vector<Curve> profile;
  Curve path;
  Vec3d upright{0, 1, 0};
  uint32_t pieces = 1;
  bool is_loop = false;
  std::function<double(double)> scale = [](double) { return 1.0; };
};
void add_sweep(Faces& faces, const Sweep& sweep);

/// A full circle as a profile.
std::vector<Curve> circle_profile(double radius);
/// A rectangle with rounded corners as a profile.
std::vector<Curve> rounded_rectangle_profile(double width, double height, double radius);

/// A solid between two sheets that are maps of the same rectangle, cut into cells by `s` and `t`, with holes through
/// it. Each cell is a face, one with a hole four.
struct Sheets {
  Surface outer, inner;      ///< seen from outside, s turns to t counter-clockwise on the outer one
  std::vector<double> s, t;  ///< ascending
  struct Hole {
    uint32_t i, j;              ///< the cell
    double radius_s, radius_t;  ///< less than half the cell
  };
  std::vector<Hole> holes;
  /// Where given, a half circle joins the sheets along their rim, out in this direction at a point; else a straight
  /// wall.
  std::function<Vec3d(Vec3d)> round_rim;
};
void add_sheets(Faces& faces, const Sheets& sheets);

/// A cubic Bezier curve.
Curve bezier_curve(const std::array<Vec3d, 4>& points);

/// Moves all faces from the number `first` on.
void place_faces(Faces& faces, size_t first, const Transform& place);

/// Cuts a part to about `triangles`: the edge grows as `edge` and the chord as its square, until the count fits.
Mesh tessellate_to(const Tessellator& part, uint64_t triangles, const Fineness& shape);

}  // namespace kerf
