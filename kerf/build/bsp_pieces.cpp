#include "kerf/build/bsp_pieces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "kerf/base/work_limit.h"
#include "kerf/build/convex_cell.h"
#include "kerf/geometry/clip.h"

namespace kerf {
namespace {

float area_of(std::span<const Vec3d> corners) {
  Vec3d sum;
  for (size_t i = 2; i < corners.size(); ++i) {
    sum = sum + cross(corners[i - 1] - corners[0], corners[i] - corners[0]);
  }
  return static_cast<float>(0.5 * std::sqrt(dot(sum, sum)));
}

}  // namespace

void BspPieces::add(BspPiece piece, std::span<const Vec3d> corners) {
  if (corners.empty()) return;
  Vec3d lower = corners[0], upper = corners[0];
  for (const Vec3d& c : corners) {
    lower = min(lower, c);
    upper = max(upper, c);
  }
  piece.bounds = outward(lower, upper);
  piece.first = static_cast<uint32_t>(corners_.size());
  piece.count = static_cast<uint32_t>(corners.size());
  piece.area = area_of(corners);
  corners_.insert(corners_.end(), corners.begin(), corners.end());
  list_.push_back(piece);
}

void BspPieces::add_whole(uint32_t number) {
  const Reference& reference = (*references_)[number];
  BspPiece piece{reference.bounds(), number, 0, 0, 0, false};
  const auto& shapes = geometries_[reference.geometry].shapes;
  if (const auto* mesh = std::get_if<TriangleMesh>(&shapes)) {
    const Triangle t = mesh->triangle(reference.primitive);
    add(piece, std::array{to_double(t.a), to_double(t.b), to_double(t.c)});
  } else if (const auto* parallelograms = std::get_if<Strided<Parallelogram>>(&shapes)) {
    add(piece, (*parallelograms)[reference.primitive].corners());
  } else {
    list_.push_back(piece);
  }
}

Box3f BspPieces::bounds() const {
  Box3f bounds;
  for (const BspPiece& piece : list_) bounds.extend(piece.bounds);
  return bounds;
}

std::optional<BspPlane> BspPieces::plane_of(const BspPiece& piece) const {
  const Reference& reference = reference_of(piece);
  const auto& shapes = geometries_[reference.geometry].shapes;
  Vec3d normal, middle;
  if (const auto* mesh = std::get_if<TriangleMesh>(&shapes)) {
    const Triangle t = mesh->triangle(reference.primitive);
    const Vec3d a = to_double(t.a), b = to_double(t.b), c = to_double(t.c);
    normal = cross(b - a, c - a);
    middle = (a + b + c) / 3;
  } else if (const auto* parallelograms = std::get_if<Strided<Parallelogram>>(&shapes)) {
    const Parallelogram p = (*parallelograms)[reference.primitive];
    const std::array<Vec3d, 4> c = p.corners();
    normal = cross(to_double(p.u), to_double(p.v));
    middle = (c[0] + c[2]) / 2;
  } else {
    return std::nullopt;
  }
  const double scale = largest(abs(normal));
  if (!(scale > 0)) return std::nullopt;
  normal = normal / scale;  // or squares leave the range of numbers
  BspPlane plane{to_float(normal / std::sqrt(dot(normal, normal))), 0};
  const uint32_t steep = largest_axis(abs(plane.normal));
  if (plane.normal[steep] < 0) plane.normal = -plane.normal;
  for (uint32_t axis = 0; axis < 3; ++axis) plane.normal[axis] = without_minus_zero(plane.normal[axis]);
  plane.offset = dot(to_double(plane.normal), middle);
  return plane;
}

std::pair<double, double> BspPieces::extent(const BspPiece& piece, const BspPlane& plane) const {
  if (piece.count == 0) {
    const Reference& reference = reference_of(piece);
    const Sphere sphere = std::get<Strided<Sphere>>(geometries_[reference.geometry].shapes)[reference.primitive];
    const Vec3d normal = to_double(plane.normal), lower = to_double(piece.bounds.lower);
    const Vec3d upper = to_double(piece.bounds.upper), reach = (upper - lower) * 0.5;
    const double of_box = dot(abs(normal), reach), box_middle = plane.side(lower + reach);
    const double of_ball = sphere.radius * std::sqrt(dot(normal, normal)),
                 ball_middle = plane.side(to_double(cleaned(sphere.center)));
    return {std::max(box_middle - of_box, ball_middle - of_ball), std::min(box_middle + of_box, ball_middle + of_ball)};
  }
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Vec3d& c : corners_of(piece)) {
    const double side = plane.side(c);
    low = std::min(low, side);
    high = std::max(high, side);
  }
  return {low, high};
}

BspPieces::Side BspPieces::side_of(const BspPiece& piece, const BspPlane& plane) const {
  const auto [low, high] = extent(piece, plane);
  if (high <= tolerance_) return low >= -tolerance_ ? Side::within : Side::below;
  return low >= -tolerance_ ? Side::above : Side::both;
}

BspPieces::Counts BspPieces::count(const BspPlane& plane) const {
  Counts counts;
  for (const BspPiece& piece : list_) {
    const Side side = side_of(piece, plane);
    counts.below += side != Side::above ? 1 : 0;
    counts.above += side == Side::above || side == Side::both ? 1 : 0;
  }
  return counts;
}

BspPieces::Counts BspPieces::count_across(uint32_t axis, float position) const {
  Counts counts;
  const auto low = static_cast<float>(position - tolerance_), high = static_cast<float>(position + tolerance_);
  for (const BspPiece& piece : list_) {
    const bool is_above = piece.bounds.upper[axis] > high;
    counts.above += is_above ? 1 : 0;
    counts.below += piece.bounds.lower[axis] < low || !is_above ? 1 : 0;
  }
  return counts;
}

void BspPieces::cut_polygon(const BspPiece& piece, const BspPlane& plane, BspPieces& below, BspPieces& above) const {
  thread_local std::vector<Vec3d> down, up;
  down.clear();
  up.clear();
  const std::span<const Vec3d> corners = corners_of(piece);
  Vec3d p = corners.back();
  double p_side = plane.side(p);
  for (const Vec3d& q : corners) {
    const double q_side = plane.side(q);
    if ((p_side < 0 && q_side > 0) || (p_side > 0 && q_side < 0)) {
      const Vec3d c = p_side < 0 ? crossing(p, p_side, q, q_side) : crossing(q, q_side, p, p_side);
      down.push_back(c);
      up.push_back(c);
    }
    if (q_side <= 0) down.push_back(q);
    if (q_side >= 0) up.push_back(q);
    p = q;
    p_side = q_side;
  }
  below.add(piece, down);
  above.add(piece, up);
}

void BspPieces::cut_sphere(const BspPiece& piece, const BspPlane& plane, BspPieces& below, BspPieces& above) const {
  BspPiece down = piece, up = piece;
  const Reference& reference = reference_of(piece);
  const uint32_t axis = plane.kind();
  if (axis != BspPlane::kOblique) {
    down.bounds.upper[axis] = std::min(down.bounds.upper[axis], round_up(plane.offset));
    up.bounds.lower[axis] = std::max(up.bounds.lower[axis], round_down(plane.offset));
    const Geometry& geometry = geometries_[reference.geometry];
    down.bounds = clipped_bounds(geometry, reference.primitive, down.bounds);
    up.bounds = clipped_bounds(geometry, reference.primitive, up.bounds);
  }
  const bool is_lost = down.bounds.is_empty() && up.bounds.is_empty();  // only rounding can do that
  if (is_lost) down.bounds = up.bounds = piece.bounds;
  if (!down.bounds.is_empty()) below.list_.push_back(down);
  if (!up.bounds.is_empty()) above.list_.push_back(up);
}

std::pair<BspPieces, BspPieces> BspPieces::cut(const BspPlane& plane) const {
  std::pair<BspPieces, BspPieces> parts{{geometries_, *references_, tolerance_},
                                        {geometries_, *references_, tolerance_}};
  auto& [below, above] = parts;
  LimitWatch watch;
  for (const BspPiece& piece : list_) {
    watch.step();
    const Side side = side_of(piece, plane);
    if (side == Side::both) {
      piece.count > 0 ? cut_polygon(piece, plane, below, above) : cut_sphere(piece, plane, below, above);
      continue;
    }
    BspPieces& to = side == Side::above ? above : below;
    BspPiece& moved = to.list_.emplace_back(piece);
    moved.is_flush = piece.is_flush || side == Side::within;
    moved.first = static_cast<uint32_t>(to.corners_.size());
    const std::span<const Vec3d> corners = corners_of(piece);
    to.corners_.insert(to.corners_.end(), corners.begin(), corners.end());
  }
  return parts;
}

}  // namespace kerf
