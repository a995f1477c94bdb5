// A teapot in a stadium: rows of large coarse seats around a small, finely cut pot in the middle of the field. Grids of
// equal cells fail here, as one cell holds the pot. The pot is Kerf's own: revolved body and lid, swept spout and
// handle.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kerf/study/models/models.h"
#include "kerf/study/models/surfaces.h"

namespace kerf {
namespace {

// In metres.
constexpr Vec3d kField{53, 0, 34};  // half of its length and width
constexpr uint32_t kRows = 40, kSections = 64;
constexpr double kRowDepth = 0.85, kFirstRise = 0.35, kMoreRise = 0.008;
constexpr double kPotScale = 0.1;
constexpr double kStand = 0.9;  // the height of the table under the pot

/// The teapot, 1 high to the lid, z up.
Faces teapot() {
  Faces faces;
  add_revolved(faces,
               {{0, 0.04},
                {0.36, 0.04, 0.02},
                {0.40, 0, 0.015},
                {0.46, 0, 0.02},
                {0.44, 0.07, 0.05},
                {0.80, 0.42, 0.45},
                {0.56, 0.90, 0.2},
                {0.58, 0.95, 0.02},
                {0.53, 0.95, 0.02},
                {0.52, 0.90, 0.1},
                {0.74, 0.42, 0.40},
                {0.40, 0.09, 0.1},
                {0, 0.09}},
               {});
  add_revolved(faces,
               {{0, 0.91},
                {0.515, 0.91, 0.01},
                {0.52, 0.96, 0.01},
                {0.40, 1.02, 0.2},
                {0.07, 1.07, 0.03},
                {0.06, 1.10, 0.02},
                {0.12, 1.16, 0.05},
                {0.08, 1.22, 0.04},
                {0, 1.22}},
               {});
  Sweep spout{circle_profile(0.12),
              bezier_curve({Vec3d{0.62, 0, 0.36}, {1.12, 0, 0.36}, {0.92, 0, 0.82}, {1.25, 0, 0.93}}),
              {0, 1, 0},
              2};
  spout.scale = [](double v) { return 1.35 - 0.85 * v; };
  add_sweep(faces, spout);
  Sweep handle{rounded_rectangle_profile(0.12, 0.08, 0.035),
               bezier_curve({Vec3d{-0.58, 0, 0.80}, {-1.25, 0, 0.95}, {-1.25, 0, 0.30}, {-0.66, 0, 0.30}}),
               {0, 1, 0},
               3};
  add_sweep(faces, handle);
  const Transform upright = rotation(kX, -90);
  Transform place;
  for (uint32_t axis = 0; axis < 3; ++axis) place.column[axis] = upright.column[axis] * kPotScale;
  place.translation = {0, kStand, 0};
  place_faces(faces, 0, place);
  return faces;
}

/// Around the field, `out` from its edge: a rectangle with quarter circles at its corners.
Vec3d ring_point(double out, double height, double turn) {
  const double angle = 2 * std::numbers::pi * turn;
  const double x = std::cos(angle), z = std::sin(angle);
  // A superellipse, so that all rings are alike.
  const double scale = std::pow(x * x * x * x + z * z * z * z, -0.25);
  return {(kField.x + 8 + out) * x * scale, height, (kField.z + 8 + out) * z * scale};
}

struct MeshPen {
  Mesh& mesh;
  void quad(Vec3d a, Vec3d b, Vec3d c, Vec3d d) {
    const auto first = static_cast<uint32_t>(mesh.vertices.size());
    for (const Vec3d p : {a, b, c, d}) mesh.vertices.push_back(to_float(p));
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
  }
};

/// Field, table and `rows` rows of seats, each a step around the field.
Mesh bowl(uint32_t rows, uint32_t sections) {
  Mesh mesh;
  MeshPen pen{mesh};
  const double far = 8 + rows * kRowDepth + 4;
  pen.quad({-kField.x - far, 0, -kField.z - far}, {-kField.x - far, 0, kField.z + far},
           {kField.x + far, 0, kField.z + far}, {kField.x + far, 0, -kField.z - far});
  pen.quad({-0.4, kStand, -0.4}, {-0.4, kStand, 0.4}, {0.4, kStand, 0.4}, {0.4, kStand, -0.4});
  double height = 1;
  for (uint32_t row = 0; row < rows; ++row) {
    const double rise = kFirstRise + kMoreRise * row, out = row * kRowDepth;
    for (uint32_t i = 0; i < sections; ++i) {
      const double a = static_cast<double>(i) / sections, b = static_cast<double>(i + 1) / sections;
      const double foot = row == 0 ? 0 : height;
      pen.quad(ring_point(out, foot, b), ring_point(out, foot, a), ring_point(out, height + rise, a),
               ring_point(out, height + rise, b));
      pen.quad(ring_point(out, height + rise, b), ring_point(out, height + rise, a),
               ring_point(out + kRowDepth, height + rise, a), ring_point(out + kRowDepth, height + rise, b));
    }
    height += rise;
  }
  return mesh;
}

void append(Mesh& mesh, const Mesh& more) {
  const auto first = static_cast<uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), more.vertices.begin(), more.vertices.end());
  for (const Mesh::Corners& t : more.triangles) mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

}  // namespace

MadeModel make_stadium(uint64_t triangles, uint64_t) {
  constexpr double kBowlShare = 0.25;  // at most, of all triangles
  constexpr uint32_t kLeastRows = 4, kLeastSections = 12;
  const double fit = std::min(1.0, std::sqrt(kBowlShare * static_cast<double>(triangles) / (4.0 * kRows * kSections)));
  const auto scaled = [fit](uint32_t full, uint32_t least) {
    return std::max(least, static_cast<uint32_t>(full * fit));
  };
  MadeModel model{bowl(scaled(kRows, kLeastRows), scaled(kSections, kLeastSections)), {}};
  const uint64_t used = model.mesh.triangles.size();
  const Tessellator pot(teapot());
  append(model.mesh, tessellate_to(pot, triangles - std::min(triangles, used), {0.02, 0.0002}));
  model.camera = {{0.32, kStand + 0.28, 0.42}, {0, kStand + 0.06, 0}, {0, 1, 0}, 55};
  return model;
}

}  // namespace kerf
