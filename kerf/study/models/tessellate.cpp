// What the faces of a part have in common, and how finely each direction is cut.

#include "kerf/study/models/tessellate.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string>

#include "kerf/base/error.h"
#include "kerf/base/parallel.h"

namespace kerf {
namespace {

constexpr double kTolerance = 1e-7;          // of the size of the part: points nearer than that are one
constexpr double kStep = 1e-5;               // of the parameters, for tangents
constexpr double kSafety = 0.99;             // of the largest edge, as tangents are known at samples only
constexpr double kGrowth = 1.02;             // of the segments of a direction that is found too coarse
constexpr uint32_t kMostSegments = 1 << 26;  // of one direction: twice the triangles that there may be
constexpr uint32_t kLeastBetweenPoles = 2;   // as with one a ball has no triangles
constexpr uint32_t kLeastAround = 3;         // segments of a closed curve

double length(Vec3d v) { return std::sqrt(dot(v, v)); }
bool is_finite(Vec3d v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

Vec3d derivative(const Surface& surface, double u, double v, bool by_u) {
  const double low = std::max((by_u ? u : v) - kStep, 0.0), high = std::min((by_u ? u : v) + kStep, 1.0);
  const Vec3d difference = by_u ? surface(high, v) - surface(low, v) : surface(u, high) - surface(u, low);
  return difference / (high - low);
}

uint32_t root_of(std::vector<uint32_t>& parents, uint32_t i) {
  while (parents[i] != i) i = parents[i] = parents[parents[i]];
  return i;
}

}  // namespace

Tessellator::Tessellator(std::vector<Surface> faces) {
  faces_.resize(faces.size());
  for (size_t i = 0; i < faces.size(); ++i) faces_[i].surface = std::move(faces[i]);
  parallel_for(faces_.size(), 8, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) survey(i);
  });
  join_corners();
  join_sides();
  join_directions();
}

/// Samples the tangents of a face and how it bends.
void Tessellator::survey(size_t number) {
  Face& face = faces_[number];
  constexpr uint32_t kRow = kSamples + 1;
  std::vector<Vec3d> points(kRow * kRow);
  double skew = 0;
  for (uint32_t j = 0; j < kRow; ++j) {
    for (uint32_t i = 0; i < kRow; ++i) {
      const double u = static_cast<double>(i) / kSamples, v = static_cast<double>(j) / kSamples;
      points[j * kRow + i] = face.surface(u, v);
      const Vec3d by_u = derivative(face.surface, u, v, true), by_v = derivative(face.surface, u, v, false);
      if (!is_finite(points[j * kRow + i]) || !is_finite(by_u) || !is_finite(by_v)) {
        throw Error(ErrorCode::invalid_geometry, "face " + std::to_string(number), "its surface is not finite");
      }
      face.tangents.push_back({by_u, by_v});
      skew += dot(by_u, by_v);
    }
  }
  face.falling = skew > 0;
  measure_bend(face, points);
}

void Tessellator::measure_bend(Face& face, const std::vector<Vec3d>& points) const {
  constexpr uint32_t kRow = kSamples + 1;
  for (uint32_t direction = 0; direction < 2; ++direction) {
    const uint32_t step = direction == 0 ? 1 : kRow, across = direction == 0 ? kRow : 1;
    for (uint32_t line = 0; line < kRow; ++line) {
      for (uint32_t i = 1; i < kSamples; ++i) {
        const Vec3d* p = &points[line * across + i * step];
        const Vec3d before = p[0] - *(p - step), after = p[step] - p[0], along = p[step] - *(p - step);
        const double square = dot(along, along);
        Vec3d turn = after - before;
        if (square > 0) turn = turn - along * (dot(turn, along) / square);  // pace is no bend
        face.bend[direction] = std::max(face.bend[direction], length(turn) * kSamples * kSamples / 8);
      }
    }
  }
}

/// Numbers the corners of all faces, those in one place alike.
void Tessellator::join_corners() {
  struct Corner {
    Vec3d point;
    uint32_t* number;
  };
  std::vector<Corner> all;
  Vec3d low, high;
  for (Face& face : faces_) {
    constexpr double kAt[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    for (uint32_t i = 0; i < 4; ++i) {
      const Vec3d point = face.surface(kAt[i][0], kAt[i][1]);
      low = all.empty() ? point : min(low, point);
      high = all.empty() ? point : max(high, point);
      all.push_back({point, &face.corners[i]});
      for (const auto& tangent : face.tangents) tolerance_ = std::max(tolerance_, largest(abs(tangent[i % 2])));
    }
  }
  tolerance_ = std::max(tolerance_, largest(high - low)) * kTolerance;
  std::stable_sort(all.begin(), all.end(), [](const Corner& a, const Corner& b) { return a.point.x < b.point.x; });
  size_t window = 0;  // corners from here on may lie in the same place
  for (const Corner& corner : all) {
    while (window < corners_.size() && corners_[window].x < corner.point.x - tolerance_) ++window;
    size_t same = window;
    while (same < corners_.size() && length(corners_[same] - corner.point) > tolerance_) ++same;
    if (same == corners_.size()) corners_.push_back(corner.point);
    *corner.number = static_cast<uint32_t>(same);
  }
}

Vec3d Tessellator::side_point(const Edge& edge, double t) const {
  const Surface& surface = faces_[edge.face].surface;
  if (edge.side % 2 == 0) return surface(t, edge.side == 0 ? 0 : 1);
  return surface(edge.side == 1 ? 1 : 0, t);
}

bool Tessellator::is_same_curve(const Edge& a, const Edge& b, bool reversed) const {
  for (const double t : {0.25, 0.5, 0.75}) {
    if (length(side_point(a, t) - side_point(b, reversed ? 1 - t : t)) > tolerance_) return false;
  }
  return true;
}

/// Finds the edges: sides that are the same curve are one.
void Tessellator::join_sides() {
  std::map<std::pair<uint32_t, uint32_t>, std::vector<uint32_t>> by_corners;
  for (uint32_t f = 0; f < faces_.size(); ++f) {
    for (uint32_t side = 0; side < kSides; ++side) {
      constexpr uint32_t kEnds[kSides][2] = {{0, 1}, {1, 2}, {3, 2}, {0, 3}};
      Edge edge{f, side, faces_[f].corners[kEnds[side][0]], faces_[f].corners[kEnds[side][1]]};
      std::vector<uint32_t>& near = by_corners[std::minmax(edge.begin, edge.end)];
      Use use{static_cast<uint32_t>(edges_.size())};
      for (const uint32_t e : near) {
        const Edge& other = edges_[e];
        if (edge.begin == other.begin && is_same_curve(edge, other, false)) use = {e, false};
        if (edge.begin == other.end && is_same_curve(edge, other, true)) use = {e, true};
      }
      if (use.edge == edges_.size()) {
        edge.is_point = edge.begin == edge.end;
        for (const double t : {0.25, 0.5, 0.75}) {
          edge.is_point = edge.is_point && length(side_point(edge, t) - corners_[edge.begin]) <= tolerance_;
        }
        near.push_back(use.edge);
        edges_.push_back(edge);
      }
      faces_[f].sides[side] = use;
    }
  }
}

/// Opposite sides of a face are cut alike, from face to face through all that hangs together.
void Tessellator::join_directions() {
  std::vector<uint32_t> parents(edges_.size());
  std::iota(parents.begin(), parents.end(), 0);
  for (const Face& face : faces_) {
    for (uint32_t d = 0; d < 2; ++d) {
      const uint32_t a = face.sides[d].edge, b = face.sides[d + 2].edge;
      if (!edges_[a].is_point && !edges_[b].is_point) parents[root_of(parents, a)] = root_of(parents, b);
    }
  }
  std::vector<uint32_t> numbers(edges_.size(), kNone);
  for (uint32_t e = 0; e < edges_.size(); ++e) {
    if (edges_[e].is_point) continue;
    uint32_t& number = numbers[root_of(parents, e)];
    if (number == kNone) {
      number = static_cast<uint32_t>(least_.size());
      least_.push_back(1);
    }
    edges_[e].direction = number;
    if (edges_[e].begin == edges_[e].end) least_[number] = std::max(least_[number], kLeastAround);
  }
  for (Face& face : faces_) {
    for (uint32_t d = 0; d < 2; ++d) {
      const Edge &a = edges_[face.sides[d].edge], &b = edges_[face.sides[d + 2].edge];
      face.directions[d] = a.is_point ? b.direction : a.direction;
      if (face.directions[d] == kNone) {  // from pole to pole
        face.directions[d] = static_cast<uint32_t>(least_.size());
        least_.push_back(1);
      }
      const uint32_t from = face.sides[3 - d].edge, to = face.sides[1 - d].edge;
      const bool is_between_poles = edges_[from].is_point && edges_[to].is_point;
      const uint32_t least = from == to ? kLeastAround : is_between_poles ? kLeastBetweenPoles : 1;
      least_[face.directions[d]] = std::max(least_[face.directions[d]], least);
    }
  }
}

/// Cuts the longer side of the quads of a face more often if an edge is too long somewhere; whether it did.
bool Tessellator::cut_long_edges(const Face& face, double max_edge, Plan& plan) const {
  bool grown = false;
  for (const auto& [by_u, by_v] : face.tangents) {
    while (true) {
      uint32_t &along_u = plan[face.directions[0]], &along_v = plan[face.directions[1]];
      const Vec3d a = by_u / along_u, b = by_v / along_v, diagonal = face.falling ? a - b : a + b;
      if (std::max({dot(a, a), dot(b, b), dot(diagonal, diagonal)}) <= max_edge * max_edge) break;
      uint32_t& most = dot(a, a) > dot(b, b) ? along_u : along_v;
      if (most >= kMostSegments) break;
      most = std::max(most + 1, static_cast<uint32_t>(most * kGrowth));
      grown = true;
    }
  }
  return grown;
}

Tessellator::Plan Tessellator::plan(const Fineness& fineness) const {
  if (!(fineness.max_edge > 0) || !(fineness.chord > 0)) {
    throw Error(ErrorCode::invalid_option, "fineness", "the largest edge and the chord must be above 0");
  }
  Plan plan = least_;
  const auto raise = [&](uint32_t direction, double segments) {
    plan[direction] = std::max(plan[direction], static_cast<uint32_t>(std::min<double>(segments, kMostSegments)));
  };
  for (const Face& face : faces_) {
    for (uint32_t d = 0; d < 2; ++d) {
      raise(face.directions[d], std::ceil(std::sqrt(face.bend[d] / fineness.chord)));
      double longest = 0;
      for (const auto& tangent : face.tangents) longest = std::max(longest, dot(tangent[d], tangent[d]));
      raise(face.directions[d], std::ceil(std::sqrt(longest) / (fineness.max_edge * kSafety)));
    }
  }
  for (bool grown = true; grown;) {
    grown = false;
    for (const Face& face : faces_) grown |= cut_long_edges(face, fineness.max_edge * kSafety, plan);
  }
  return plan;
}

uint64_t Tessellator::triangles_of(const Face& face, const Plan& plan) const {
  const uint64_t along[2] = {plan[face.directions[0]], plan[face.directions[1]]};
  uint64_t triangles = 2 * along[0] * along[1];
  for (uint32_t side = 0; side < kSides; ++side) {  // at a pole each quad has one only
    if (edges_[face.sides[side].edge].is_point) triangles -= along[side % 2];
  }
  return triangles;
}

uint64_t Tessellator::count(const Fineness& fineness) const {
  const Plan segments = plan(fineness);
  uint64_t triangles = 0;
  for (const Face& face : faces_) triangles += triangles_of(face, segments);
  return triangles;
}

}  // namespace kerf
