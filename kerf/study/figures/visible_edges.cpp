#include "kerf/study/figures/visible_edges.h"

#include <algorithm>
#include <cmath>

namespace kerf {
namespace {

/// An edge in front of the camera and where it is seen. Along it `s` runs from 0 to 1 in the picture.
struct SeenEdge {
  Vec3d a, b;
  double depth_a, depth_b;
  Point2 from, to;

  Point2 at(double s) const { return from + (to - from) * s; }
  /// The point that is seen there: perspective makes depth's inverse linear.
  Vec3d point(double s) const {
    const double weight_a = (1 - s) / depth_a, weight_b = s / depth_b;
    return a + (b - a) * (weight_b / (weight_a + weight_b));
  }
};

/// Narrows [begin, end] to where from + (to - from) * s lies in [0, most].
void narrow(double from, double to, double most, double& begin, double& end) {
  const double step = to - from;
  if (step == 0) {
    if (from < 0 || from > most) end = -1;
    return;
  }
  const double s0 = -from / step, s1 = (most - from) / step;
  begin = std::max(begin, std::min(s0, s1));
  end = std::min(end, std::max(s0, s1));
}

bool is_seen(const SeenEdge& edge, double s, Vec3d eye, const Image& distances) {
  const Point2 at = edge.at(s);
  const auto x = std::min(static_cast<uint32_t>(std::max(at.x, 0.0)), distances.width - 1);
  const auto y = std::min(static_cast<uint32_t>(std::max(at.y, 0.0)), distances.height - 1);
  const Vec3d to = edge.point(s) - eye;
  constexpr double kSlack = 1.004;  // boxes touch what is in them
  return std::sqrt(dot(to, to)) <= kSlack * distances.pixels[size_t{y} * distances.width + x];
}

void add_seen_parts(const SeenEdge& edge, Vec3d eye, const Image& distances, std::vector<std::vector<Point2>>& lines) {
  double begin = 0, end = 1;
  narrow(edge.from.x, edge.to.x, distances.width, begin, end);
  narrow(edge.from.y, edge.to.y, distances.height, begin, end);
  if (!(begin < end)) return;
  const Point2 all = edge.at(end) - edge.at(begin);
  constexpr double kStep = 1.5;  // pixels from one look to the next
  const int steps = std::max(1, static_cast<int>(std::ceil(std::hypot(all.x, all.y) / kStep)));
  const auto share = [&](int i) { return begin + (end - begin) * i / steps; };
  for (int i = 0; i < steps;) {
    const int first = i;
    while (i < steps && is_seen(edge, (share(i) + share(i + 1)) / 2, eye, distances)) ++i;
    if (i > first) lines.push_back({edge.at(share(first)), edge.at(share(i))});
    if (i == first) ++i;
  }
}

}  // namespace

std::vector<std::vector<Point2>> visible_edges(const Box3f& box, const Projection& projection, const Image& distances) {
  std::vector<std::vector<Point2>> lines;
  if (box.is_empty()) return lines;
  const auto corner = [&](uint32_t k) {
    return Vec3d{(k & 1) != 0 ? box.upper.x : box.lower.x, (k & 2) != 0 ? box.upper.y : box.lower.y,
                 (k & 4) != 0 ? box.upper.z : box.lower.z};
  };
  const Vec3d extent = to_double(box.upper) - to_double(box.lower);
  for (uint32_t k = 0; k < 8; ++k) {
    for (uint32_t bit = 1; bit < 8; bit *= 2) {
      if ((k & bit) != 0) continue;
      Vec3d a = corner(k), b = corner(k | bit);
      const double depth_a = projection.depth(a), depth_b = projection.depth(b);
      const double near = 1e-4 * std::max(std::abs(depth_a), std::abs(depth_b)) + 1e-6 * largest(extent);
      if (std::max(depth_a, depth_b) <= near) continue;
      const double share = (near - depth_a) / (depth_b - depth_a);  // where the edge comes before the camera
      if (depth_a < near) a = a + (b - a) * share;
      if (depth_b < near) b = corner(k) + (b - corner(k)) * share;
      const SeenEdge edge{a, b, std::max(depth_a, near), std::max(depth_b, near), projection(a), projection(b)};
      add_seen_parts(edge, projection.eye(), distances, lines);
    }
  }
  return lines;
}

}  // namespace kerf
