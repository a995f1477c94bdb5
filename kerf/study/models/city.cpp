// The city: blocks of houses along straight streets. Few large walls, many small things on them: window frames, roof
// tiles, chimneys and lamps, so that triangles of all sizes lie side by side.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kerf/base/transform.h"
#include "kerf/study/models/models.h"
#include "kerf/study/models/random.h"

namespace kerf {
namespace {

// In metres.
constexpr double kLot = 18, kStreet = 12;
constexpr uint32_t kLotsAlong = 4, kLotsAcross = 2;  // of a block
constexpr double kStorey = 3.2;

class House {
 public:
  /// On the square lot with its corner at `origin`; without a mesh only counts.
  House(Mesh* mesh, Vec3d origin, ModelRandom random) : mesh_(mesh), origin_(origin), random_(random) {}

  uint64_t make() {
    const double width = random_.between(0.6, 0.95) * kLot, depth = random_.between(0.6, 0.95) * kLot;
    const auto storeys = 2 + static_cast<uint32_t>(random_.between_octaves(1, 6));
    const double height = kStorey * storeys, turn = random_.share() < 0.2 ? random_.between(0, 90) : 0;
    place_ = rotation(kY, turn);
    place_.translation = origin_ + Vec3d{kLot / 2, 0, kLot / 2};
    const double w = width / 2, d = depth / 2;
    box({-w, 0, -d}, {w, height, d});
    for (uint32_t storey = 0; storey < storeys; ++storey) {
      windows(kX, w, d, storey);
      windows(kZ, d, w, storey);
      box({-w - 0.1, kStorey * (storey + 1) - 0.15, -d - 0.1}, {w + 0.1, kStorey * (storey + 1) + 0.1, d + 0.1});
    }
    random_.share() < 0.5 ? gable(w + 0.4, d + 0.4, height) : flat_roof(w, d, height);
    lamp();
    return triangles_;
  }

 private:
  /// Frames and sills on the two walls across an axis, at `out` from the middle and `half` to either side.
  void windows(uint32_t axis, double out, double half, uint32_t storey) {
    const auto count = static_cast<uint32_t>(half * 2 / 2.4);
    for (uint32_t i = 0; i < 2 * count; ++i) {
      const double side = i < count ? 1 : -1, at = -half + 2 * half * ((i % count) + 0.5) / count;
      const double low = kStorey * storey + 1, high = low + 1.5;
      const auto bar = [&](double left, double right, double bottom, double top) {
        Vec3d a{0, bottom, 0}, b{0, top, 0};
        const double near = side * out, far = side * (out + 0.08);
        a[axis] = std::min(near, far);
        b[axis] = std::max(near, far);
        a[kX + kZ - axis] = at + left;
        b[kX + kZ - axis] = at + right;
        box(a, b);
      };
      bar(-0.6, 0.6, low - 0.1, low);
      bar(-0.6, 0.6, high, high + 0.1);
      bar(-0.04, 0.04, low, high);
    }
  }

  /// Two sloped sides of overlapping rows of tiles, and the walls under them.
  void gable(double w, double d, double height) {
    const double rise = d * random_.between(0.5, 1.0);
    constexpr double kTile = 0.8;
    const auto rows = static_cast<uint32_t>(std::ceil(d / kTile)),
               columns = static_cast<uint32_t>(std::ceil(2 * w / kTile));
    for (const double side : {-1.0, 1.0}) {
      const auto point = [&](double x, double up, double lift) {
        return Vec3d{x, height + rise * up + lift, side * d * (1 - up)};
      };
      for (uint32_t row = 0; row < rows; ++row) {
        const double low = static_cast<double>(row) / rows, high = (row + 1.2) / rows;
        for (uint32_t i = 0; i < columns; ++i) {
          const double left = -w + 2 * w * i / columns, right = -w + 2 * w * (i + 1) / columns;
          quad(point(left, low, 0.06), point(right, low, 0.06), point(right, high, 0), point(left, high, 0));
        }
      }
    }
    for (const double x : {-w, w}) {
      triangle({x, height, -d}, {x, height, d}, {x, height + rise, 0});
    }
  }

  void flat_roof(double w, double d, double height) {
    for (uint32_t i = 0; i < 4; ++i) {
      const double x = random_.between(-w, w - 2), z = random_.between(-d, d - 2);
      box({x, height, z}, {x + random_.between(0.5, 2), height + random_.between(0.5, 3), z + random_.between(0.5, 2)});
    }
    box({-0.03, height, -0.03}, {0.03, height + 8, 0.03});  // an aerial
  }

  /// A lamp post in front, six-sided.
  void lamp() {
    constexpr uint32_t kSides = 6;
    const double x = kLot / 2 - 0.4, z = kLot / 2 - 0.4;
    for (uint32_t i = 0; i < kSides; ++i) {
      const auto at = [&](uint32_t k, double radius, double y) {
        const double angle = 2 * std::numbers::pi * (k % kSides) / kSides;
        return Vec3d{x + radius * std::cos(angle), y, z + radius * std::sin(angle)};
      };
      quad(at(i, 0.07, 0), at(i, 0.05, 6), at(i + 1, 0.05, 6), at(i + 1, 0.07, 0));
      quad(at(i, 0.3, 6), at(i, 0.15, 6.5), at(i + 1, 0.15, 6.5), at(i + 1, 0.3, 6));
    }
  }

  void box(Vec3d low, Vec3d high) {
    triangles_ += 12;
    if (mesh_ == nullptr) return;
    const auto first = static_cast<uint32_t>(mesh_->vertices.size());
    for (uint32_t i = 0; i < 8; ++i) {
      add({i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z});
    }
    constexpr uint32_t kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (const auto& face : kFaces) {
      mesh_->triangles.push_back({first + face[0], first + face[1], first + face[2]});
      mesh_->triangles.push_back({first + face[0], first + face[2], first + face[3]});
    }
  }

  void triangle(Vec3d a, Vec3d b, Vec3d c) {
    ++triangles_;
    if (mesh_ == nullptr) return;
    const auto first = static_cast<uint32_t>(mesh_->vertices.size());
    for (const Vec3d p : {a, b, c}) add(p);
    mesh_->triangles.push_back({first, first + 1, first + 2});
  }

  void quad(Vec3d a, Vec3d b, Vec3d c, Vec3d d) {
    triangles_ += 2;
    if (mesh_ == nullptr) return;
    const auto first = static_cast<uint32_t>(mesh_->vertices.size());
    for (const Vec3d p : {a, b, c, d}) add(p);
    mesh_->triangles.push_back({first, first + 1, first + 2});
    mesh_->triangles.push_back({first, first + 2, first + 3});
  }

  void add(Vec3d p) { mesh_->vertices.push_back(to_float(place_.point(p))); }

  Mesh* mesh_;
  Vec3d origin_;
  ModelRandom random_;
  Transform place_;
  uint64_t triangles_ = 0;
};

/// The corner of a lot; a block is two lots deep and has streets on all sides.
Vec3d lot_corner(uint64_t number, uint64_t row_length) {
  const uint64_t column = number % row_length, row = number / row_length;
  const uint64_t streets_along = column / kLotsAlong + 1, streets_across = row / kLotsAcross + 1;
  return {static_cast<double>(column) * kLot + static_cast<double>(streets_along) * kStreet, 0,
          static_cast<double>(row) * kLot + static_cast<double>(streets_across) * kStreet};
}

/// The ground as a regular grid of about so many triangles.
void add_ground(Mesh& mesh, double width, double depth, uint64_t triangles) {
  const auto columns = static_cast<uint32_t>(std::max(1.0, std::sqrt(static_cast<double>(triangles) / 2)));
  const auto rows = static_cast<uint32_t>(std::max<uint64_t>(triangles / 2 / columns, 1));
  const auto first = static_cast<uint32_t>(mesh.vertices.size());
  for (uint32_t j = 0; j <= rows; ++j) {
    for (uint32_t i = 0; i <= columns; ++i)
      mesh.vertices.push_back(to_float({width * i / columns, 0, depth * j / rows}));
  }
  for (uint32_t j = 0; j < rows; ++j) {
    for (uint32_t i = 0; i < columns; ++i) {
      const uint32_t a = first + j * (columns + 1) + i, b = a + columns + 1;
      mesh.triangles.push_back({a, b, b + 1});
      mesh.triangles.push_back({a, b + 1, a + 1});
    }
  }
}

}  // namespace

MadeModel make_city(uint64_t triangles, uint64_t seed) {
  constexpr double kHousesShare = 0.98;  // the rest is ground
  const double most = kHousesShare * static_cast<double>(triangles);
  uint64_t houses = 0, total = 0;
  while (true) {
    const uint64_t more = House(nullptr, {}, ModelRandom(seed, houses)).make();
    if (houses > 0 && static_cast<double>(total + more) > most) break;
    total += more;
    ++houses;
  }
  const auto row_length = static_cast<uint64_t>(std::ceil(std::sqrt(static_cast<double>(houses))));
  const uint64_t rows = (houses + row_length - 1) / row_length;
  const Vec3d end = lot_corner(rows * row_length - 1, row_length) + Vec3d{kLot + kStreet, 0, kLot + kStreet};
  MadeModel model;
  add_ground(model.mesh, end.x, end.z, triangles - std::min(triangles, total));
  for (uint64_t i = 0; i < houses; ++i) House(&model.mesh, lot_corner(i, row_length), ModelRandom(seed, i)).make();
  model.camera = {
      {-0.1 * end.x - 10, 0.22 * end.x + 20, 1.05 * end.z + 20}, {0.5 * end.x, 5, 0.5 * end.z}, {0, 1, 0}, 45};
  return model;
}

}  // namespace kerf
