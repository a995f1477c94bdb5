#include "kerf/build/convex_cell.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kerf {
namespace {

double length(Vec3d v) { return std::sqrt(dot(v, v)); }

double polygon_area(const Vec3d* corners, size_t count) {
  Vec3d sum;
  for (size_t i = 2; i < count; ++i) sum = sum + cross(corners[i - 1] - corners[0], corners[i] - corners[0]);
  return 0.5 * length(sum);
}

/// Twice the area vectors of a face's part below a plane and of the segment that the plane cuts out of it, both as seen
/// from `origin`.
struct FaceCut {
  Vec3d below, segment;
};

FaceCut cut_face(const Vec3d* corners, size_t count, const BspPlane& plane, Vec3d origin) {
  FaceCut result;
  Vec3d down = origin, up = origin;  // where the outline crosses to below and to above the plane
  Vec3d p = corners[count - 1];
  double p_side = plane.side(p);
  for (size_t i = 0; i < count; ++i) {
    const Vec3d q = corners[i];
    const double q_side = plane.side(q);
    Vec3d from = p, to = q;
    if (p_side <= 0 && q_side > 0) to = up = crossing(p, p_side, q, q_side);
    if (p_side > 0 && q_side <= 0) from = down = crossing(q, q_side, p, p_side);
    if (p_side <= 0 || q_side <= 0) result.below = result.below + cross(from - origin, to - origin);
    p = q;
    p_side = q_side;
  }
  result.segment = cross(up - origin, down - origin);
  result.below = result.below + result.segment;
  return result;
}

/// Puts the corners of a convex polygon in order, counter-clockwise seen from the tip of the plane's normal, each once.
void order_around(std::vector<Vec3d>& corners, const BspPlane& plane) {
  const Vec3d normal = to_double(plane.normal);
  Vec3d other;
  const Vec3d steep = abs(normal);
  other[steep.x <= steep.y && steep.x <= steep.z ? 0 : steep.y <= steep.z ? 1 : 2] = 1;
  const Vec3d u = cross(other, normal), v = cross(normal, u);
  Vec3d middle;
  for (const Vec3d& c : corners) middle = middle + c / static_cast<double>(corners.size());
  std::vector<std::pair<double, Vec3d>> turned;
  turned.reserve(corners.size());
  for (const Vec3d& c : corners) turned.emplace_back(std::atan2(dot(c - middle, v), dot(c - middle, u)), c);
  std::stable_sort(turned.begin(), turned.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  corners.clear();
  for (const auto& [angle, c] : turned) {
    if (corners.empty() || !(corners.back() == c)) corners.push_back(c);
  }
}

}  // namespace

ConvexCell::ConvexCell(const Box3f& box) {
  const Vec3d ends[2] = {to_double(box.lower), to_double(box.upper)};
  for (uint32_t axis = 0; axis < 3; ++axis) {
    const uint32_t b = (axis + 1) % 3, c = (axis + 2) % 3;
    for (uint32_t side = 0; side < 2; ++side) {
      const auto begin = static_cast<uint32_t>(corners_.size());
      for (uint32_t i = 0; i < 4; ++i) {
        const uint32_t k = side == 1 ? i : 3 - i;  // outward by the right hand
        Vec3d& corner = corners_.emplace_back();
        corner[axis] = ends[side][axis];
        corner[b] = ends[k == 1 || k == 2 ? 1 : 0][b];
        corner[c] = ends[k >= 2 ? 1 : 0][c];
      }
      close_face(begin);
    }
  }
}

void ConvexCell::close_face(uint32_t begin) {
  const auto end = static_cast<uint32_t>(corners_.size());
  if (end - begin < 3) {
    corners_.resize(begin);
    return;
  }
  faces_.push_back({begin, end, polygon_area(&corners_[begin], end - begin)});
  area_ += faces_.back().area;
}

ConvexCell::Areas ConvexCell::areas_after(const BspPlane& plane) const {
  Areas areas;
  Vec3d cap;
  const Vec3d origin = corners_.empty() ? Vec3d{} : corners_[0];
  for (const Face& face : faces_) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (uint32_t i = face.begin; i < face.end; ++i) {
      const double side = plane.side(corners_[i]);
      low = std::min(low, side);
      high = std::max(high, side);
    }
    if (high <= 0 || low > 0) {
      (high <= 0 ? areas.below : areas.above) += face.area;
      continue;
    }
    const FaceCut part = cut_face(&corners_[face.begin], face.end - face.begin, plane, origin);
    const double below = std::min(0.5 * length(part.below), face.area);
    areas.below += below;
    areas.above += face.area - below;
    cap = cap + part.segment;
  }
  const double lid = 0.5 * length(cap);
  if (areas.below > 0) areas.below += lid;
  if (areas.above > 0) areas.above += lid;
  return areas;
}

ConvexCell::Parts ConvexCell::cut(const BspPlane& plane) const {
  Parts parts;
  std::vector<Vec3d> lid;
  for (const Face& face : faces_) {
    const auto below = static_cast<uint32_t>(parts.below.corners_.size());
    const auto above = static_cast<uint32_t>(parts.above.corners_.size());
    bool reaches_below = false, reaches_above = false;
    Vec3d p = corners_[face.end - 1];
    double p_side = plane.side(p);
    for (uint32_t i = face.begin; i < face.end; ++i) {
      const Vec3d q = corners_[i];
      const double q_side = plane.side(q);
      if ((p_side < 0 && q_side > 0) || (p_side > 0 && q_side < 0)) {
        const Vec3d c = p_side < 0 ? crossing(p, p_side, q, q_side) : crossing(q, q_side, p, p_side);
        parts.below.corners_.push_back(c);
        parts.above.corners_.push_back(c);
        lid.push_back(c);
      }
      if (q_side <= 0) parts.below.corners_.push_back(q);
      if (q_side >= 0) parts.above.corners_.push_back(q);
      if (q_side == 0) lid.push_back(q);
      reaches_below = reaches_below || q_side < 0;
      reaches_above = reaches_above || q_side > 0;
      p = q;
      p_side = q_side;
    }
    if (!reaches_below && reaches_above) parts.below.corners_.resize(below);
    if (!reaches_above) parts.above.corners_.resize(above);
    parts.below.close_face(below);
    parts.above.close_face(above);
  }
  if (parts.below.faces_.empty() || parts.above.faces_.empty() || lid.size() < 3) return parts;
  order_around(lid, plane);
  const auto below = static_cast<uint32_t>(parts.below.corners_.size());
  const auto above = static_cast<uint32_t>(parts.above.corners_.size());
  parts.below.corners_.insert(parts.below.corners_.end(), lid.begin(), lid.end());
  parts.above.corners_.insert(parts.above.corners_.end(), lid.rbegin(), lid.rend());
  parts.below.close_face(below);
  parts.above.close_face(above);
  return parts;
}

std::pair<Vec3d, Vec3d> ConvexCell::bounds() const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Vec3d lower{kInfinity, kInfinity, kInfinity}, upper = -lower;
  for (const Vec3d& c : corners_) {
    lower = min(lower, c);
    upper = max(upper, c);
  }
  return {lower, upper};
}

}  // namespace kerf
