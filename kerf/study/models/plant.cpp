// The plant: pipes in all directions between floors and walls. It stands in for the part of the Power Plant in Ernst
// and Greiner, "Early Split Clipping for Bounding Volume Hierarchies" (2007), at 1,667,578 triangles.
//
// Its numbers are those of a building and were fixed before a ray was traced through it. Lengths are in metres. A pipe
// is from 15 to 60 mm in radius, as most are in a plant, and 50 to 400 radii long; it has as many facets as keep within
// 2 mm of its surface, and one segment from end to end. One piece of twenty is a slab, a floor field or a wall panel
// between columns. The hall grows with the number of pieces: there is so much room in it that a straight line meets a
// slab about every 3 m, which is the height of a storey. So the neighbourhood of a pipe is the same at every size.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kerf/study/models/models.h"
#include "kerf/study/models/random.h"

namespace kerf {
namespace {

constexpr double kLeastRadius = 0.015, kMostRadius = 0.060;
constexpr double kLeastSlenderness = 50, kMostSlenderness = 400;  // length over radius
constexpr double kChordTolerance = 0.002;

constexpr double kSlabShare = 0.05;               // of all pieces
constexpr double kFloorShare = 0.5;               // of the slabs; the others are walls, half of them across each way
constexpr double kLeastSlab = 6, kMostSlab = 24;  // edges
constexpr double kLeastThick = 0.1, kMostThick = 0.4;
constexpr double kStorey = 3;

constexpr Vec3d kProportions{1.6, 0.8, 1.1};  // of the hall: long, high, deep
constexpr uint32_t kSlabTriangles = 12;

/// The room that one piece has: lines that go through a volume V meet plates of the area A, all that it holds, each
/// V / (A / 2) on average (Cauchy), A being that of one side.
double volume_per_piece() {
  constexpr double kMeanEdge = (kLeastSlab + kMostSlab) / 2;
  return kStorey * kSlabShare * kMeanEdge * kMeanEdge / 2;
}

/// What is drawn first of every piece, since the size of the hall follows from how many there are.
struct Piece {
  bool is_slab;
  double radius = 0;
  uint32_t facets = 0;

  explicit Piece(ModelRandom& random) : is_slab(random.share() < kSlabShare) {
    if (is_slab) return;
    radius = random.between_octaves(kLeastRadius, kMostRadius);
    facets = static_cast<uint32_t>(std::ceil(std::numbers::pi / std::acos(1 - kChordTolerance / radius)));
  }
  uint64_t triangles() const { return is_slab ? kSlabTriangles : 2 * facets; }
};

/// A centre from which a piece with this half extent stays inside the hall, in its middle where the hall is too small.
Vec3d place_in(Vec3d hall, Vec3d half_extent, ModelRandom& random) {
  const Vec3d slack = max(hall - 2 * half_extent, Vec3d{}) * 0.5;
  return random.point_between(hall * 0.5 - slack, hall * 0.5 + slack);
}

void add_slab(Mesh& mesh, Vec3d hall, ModelRandom& random) {
  const double turn = random.share();
  const uint32_t across = turn < kFloorShare ? kY : turn < kFloorShare + (1 - kFloorShare) / 2 ? kX : kZ;
  Vec3d half;
  for (uint32_t axis = 0; axis < 3; ++axis) {
    half[axis] = (axis == across ? random.between(kLeastThick, kMostThick) : random.between(kLeastSlab, kMostSlab)) / 2;
  }
  const Vec3d center = place_in(hall, half, random);
  const auto first = static_cast<uint32_t>(mesh.vertices.size());
  for (uint32_t corner = 0; corner < 8; ++corner) {
    const Vec3d sign{corner & 1 ? 1.0 : -1.0, corner & 2 ? 1.0 : -1.0, corner & 4 ? 1.0 : -1.0};
    mesh.vertices.push_back(to_float(center + Vec3d{sign.x * half.x, sign.y * half.y, sign.z * half.z}));
  }
  constexpr uint32_t kSides[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                     {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto& side : kSides) {
    mesh.triangles.push_back({first + side[0], first + side[1], first + side[2]});
    mesh.triangles.push_back({first + side[0], first + side[2], first + side[3]});
  }
}

/// An open tube in any direction.
void add_pipe(Mesh& mesh, const Piece& piece, Vec3d hall, ModelRandom& random) {
  const Vec3d along = random.direction();
  const double half_length = piece.radius * random.between(kLeastSlenderness, kMostSlenderness) / 2;
  const double roll = random.between(0, 2 * std::numbers::pi);
  const Vec3d radius{piece.radius, piece.radius, piece.radius};
  const Vec3d center = place_in(hall, abs(along) * half_length + radius, random);
  const uint32_t flattest = std::abs(along.x) < std::abs(along.y) ? (std::abs(along.x) < std::abs(along.z) ? kX : kZ)
                                                                  : (std::abs(along.y) < std::abs(along.z) ? kY : kZ);
  Vec3d axis;
  axis[flattest] = 1;
  Vec3d u = cross(axis, along);
  u = u / std::sqrt(dot(u, u));
  const Vec3d v = cross(along, u);
  const auto first = static_cast<uint32_t>(mesh.vertices.size());
  for (uint32_t i = 0; i < piece.facets; ++i) {
    const double angle = roll + 2 * std::numbers::pi * i / piece.facets;
    const Vec3d out = (u * std::cos(angle) + v * std::sin(angle)) * piece.radius;
    mesh.vertices.push_back(to_float(center - along * half_length + out));
    mesh.vertices.push_back(to_float(center + along * half_length + out));
  }
  for (uint32_t i = 0; i < piece.facets; ++i) {
    const uint32_t a = first + 2 * i, b = first + 2 * ((i + 1) % piece.facets);
    mesh.triangles.push_back({a, b, b + 1});
    mesh.triangles.push_back({a, b + 1, a + 1});
  }
}

}  // namespace

MadeModel make_plant(uint64_t triangles, uint64_t seed) {
  uint64_t pieces = 0, total = 0;
  for (; total < std::max<uint64_t>(triangles, 1); ++pieces) {
    ModelRandom random(seed, pieces);
    total += Piece(random).triangles();
  }
  const double proportions = kProportions.x * kProportions.y * kProportions.z;
  const Vec3d hall = kProportions * std::cbrt(volume_per_piece() * static_cast<double>(pieces) / proportions);
  MadeModel model;
  model.mesh.triangles.reserve(total);
  model.mesh.vertices.reserve(total);
  for (uint64_t i = 0; i < pieces; ++i) {
    ModelRandom random(seed, i);
    const Piece piece(random);
    if (piece.is_slab) {
      add_slab(model.mesh, hall, random);
    } else {
      add_pipe(model.mesh, piece, hall, random);
    }
  }
  // From outside, over a corner, so near that the hall fills the picture.
  model.camera.look_at = hall * 0.5;
  model.camera.eye = hall * 0.5 + Vec3d{0.50 * hall.x, 0.25 * hall.y, 0.85 * hall.z};
  return model;
}

}  // namespace kerf
