#include "kerf/study/end_point_overlap.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "kerf/base/fp_environment.h"
#include "kerf/base/parallel.h"
#include "kerf/study/primitive_numbers.h"

namespace kerf {
namespace {

constexpr size_t kPrimitiveBlock = 256;      // summed by one thread
constexpr uint32_t kStepsToCheck = 1 << 14;  // nodes between two looks at the limit
constexpr size_t kMostSiblings = 8;

/// A convex polygon; six cuts let one of four corners grow to ten.
struct Polygon {
  size_t size = 0;
  Vec3d corners[16];

  void push(Vec3d corner) {
    if (size < std::size(corners)) corners[size++] = corner;  // more come only of rounding, and enclose nothing
  }
};

double area_of(const Polygon& polygon) {
  Vec3d twice;
  for (size_t i = 2; i < polygon.size; ++i) {
    twice = twice + cross(polygon.corners[i - 1] - polygon.corners[0], polygon.corners[i] - polygon.corners[0]);
  }
  return 0.5 * std::sqrt(dot(twice, twice));
}

/// The corners of a flat primitive with area, in order around it; none of any other.
Polygon polygon_of(const Geometry& geometry, uint32_t primitive) {
  Polygon polygon;
  if (find_defect(geometry, primitive) != Defect::none || is_degenerate(geometry, primitive)) return polygon;
  if (const auto* mesh = std::get_if<TriangleMesh>(&geometry.shapes)) {
    const Triangle t = mesh->triangle(primitive);
    for (const Vec3f corner : {t.a, t.b, t.c}) polygon.push(to_double(corner));
  } else if (const auto* shapes = std::get_if<Strided<Parallelogram>>(&geometry.shapes)) {
    for (const Vec3d corner : (*shapes)[primitive].corners()) polygon.push(corner);
  }
  return polygon;
}

/// Keeps the side of the plane where sign * (x - position) >= 0 (Sutherland and Hodgman 1974, one plane).
void keep_side(const Polygon& from, Polygon& to, uint32_t axis, double position, double sign) {
  to.size = 0;
  for (size_t i = 0; i < from.size; ++i) {
    const Vec3d p = from.corners[i], q = from.corners[i + 1 == from.size ? 0 : i + 1];
    const double p_side = sign * (p[axis] - position), q_side = sign * (q[axis] - position);
    if (p_side >= 0) to.push(p);
    if ((p_side > 0 && q_side < 0) || (p_side < 0 && q_side > 0)) {
      Vec3d cut = p + (q - p) * (p_side / (p_side - q_side));
      cut[axis] = position;
      to.push(cut);
    }
  }
}

/// A polygon ready to be compared with many boxes.
struct Surface {
  Polygon polygon;
  Vec3d lower, upper, normal;
  double area = 0;

  explicit Surface(const Polygon& from) : polygon(from) {
    if (polygon.size == 0) return;
    lower = upper = polygon.corners[0];
    for (const Vec3d corner : std::span(polygon.corners, polygon.size)) {
      lower = min(lower, corner);
      upper = max(upper, corner);
    }
    normal = cross(polygon.corners[1] - polygon.corners[0], polygon.corners[2] - polygon.corners[0]);
    area = area_of(polygon);
  }

  /// False if its own box does not reach the other one.
  bool is_near(const Box3f& box) const {
    return lower.x <= box.upper.x && upper.x >= box.lower.x && lower.y <= box.upper.y && upper.y >= box.lower.y &&
           lower.z <= box.upper.z && upper.z >= box.lower.z;
  }

  bool is_within(const Box3f& box) const {
    return lower.x >= box.lower.x && upper.x <= box.upper.x && lower.y >= box.lower.y && upper.y <= box.upper.y &&
           lower.z >= box.lower.z && upper.z <= box.upper.z;
  }

  /// False if its plane passes the box by, and by more than rounding.
  bool plane_meets(const Box3f& box) const {
    const Vec3d from = polygon.corners[0];
    double middle = 0, reach = 0, size = 0;
    for (uint32_t axis = 0; axis < 3; ++axis) {
      const double below = box.lower[axis] - from[axis], above = box.upper[axis] - from[axis];
      middle += normal[axis] * (below + above);
      reach += std::abs(normal[axis]) * (above - below);
      size += std::abs(normal[axis]) * (std::abs(below) + std::abs(above));
    }
    return std::abs(middle) <= reach + 0x1p-45 * size;
  }

  double area_within(const Box3f& box) const {
    Polygon buffer[2];
    const Polygon* current = &polygon;
    int next = 0;
    const auto keep = [&](uint32_t axis, double position, double sign) {
      keep_side(*current, buffer[next], axis, position, sign);
      current = &buffer[std::exchange(next, 1 - next)];
    };
    for (uint32_t axis = 0; axis < 3; ++axis) {
      if (lower[axis] < box.lower[axis]) keep(axis, box.lower[axis], 1);
      if (upper[axis] > box.upper[axis]) keep(axis, box.upper[axis], -1);
    }
    return current == &polygon ? area : area_of(*current);
  }
};

/// A node in an array where its subtree follows it and ends before node `end`.
struct FlatNode {
  Box3f bounds;
  uint32_t end = 0;
  uint32_t cost = 0;  ///< of a visit; 0 for one that no ray visits
};

/// A node and all below it.
struct Subtree {
  Box3f shared;  ///< lies in each of their boxes
  double cost = 0;
};

/// The nodes of a structure, and where each primitive's references are. Where a node has many children, as a grid has,
/// nodes are put in between, so that many of them are passed over at once.
class FlatTree {
 public:
  FlatTree(const Scene& scene, const WorkLimit& limit);

  size_t primitives() const { return numbers_.size(); }
  Polygon polygon(size_t primitive) const {
    const LeafSlot slot = numbers_.slot(primitive);
    return polygon_of(geometries_[slot.geometry()], slot.primitive);
  }
  /// The sum over all nodes of their cost times the area that they cut out of a primitive without having it.
  double overlap(size_t primitive, const Surface& surface, const WorkLimit& limit) const;

 private:
  void collect(const Structure& structure);
  void add(uint32_t node);
  void add_siblings(size_t begin, size_t end);
  void sum_subtrees();

  std::span<const Geometry> geometries_;
  PrimitiveNumbers numbers_;
  std::vector<FlatNode> nodes_;
  std::vector<Subtree> subtrees_;        // of each node
  std::vector<size_t> first_reference_;  // of each primitive, in:
  std::vector<uint32_t> leaves_;         // in order

  // While it is made: nodes as they are visited, what leaves hold, and children that wait to be added.
  std::vector<FlatNode> visited_;
  std::vector<std::pair<uint32_t, size_t>> held_;  // a visited leaf, a primitive
  std::vector<uint32_t> place_, waiting_;
};

FlatTree::FlatTree(const Scene& scene, const WorkLimit& limit)
    : geometries_(scene.geometries()), numbers_(geometries_) {
  const size_t count = numbers_.size();
  const BuildReport& report = scene.report();
  limit.check(report.nodes * (2 * sizeof(FlatNode) + sizeof(Subtree) + sizeof(uint32_t)) +
              (count + 1) * sizeof(size_t) + report.references * (sizeof(held_[0]) + sizeof(uint32_t)));
  collect(scene.structure());
  place_.resize(visited_.size());
  nodes_.reserve(visited_.size());
  for (uint32_t root = 0; root < visited_.size(); root = visited_[root].end) waiting_.push_back(root);
  add_siblings(0, waiting_.size());
  sum_subtrees();
  first_reference_.assign(count + 1, 0);
  for (const auto& [leaf, primitive] : held_) ++first_reference_[primitive + 1];
  std::partial_sum(first_reference_.begin(), first_reference_.end(), first_reference_.begin());
  leaves_.resize(held_.size());
  std::vector<size_t> next(first_reference_.begin(), first_reference_.end() - 1);
  for (const auto& [leaf, primitive] : held_) leaves_[next[primitive]++] = place_[leaf];
  visited_ = {};
  held_ = {};
  place_ = waiting_ = {};
}

void FlatTree::collect(const Structure& structure) {
  std::vector<uint32_t> path;  // from the root to the node visited last
  const auto close_to = [&](size_t depth) {
    for (; path.size() > depth; path.pop_back()) visited_[path.back()].end = static_cast<uint32_t>(visited_.size());
  };
  structure.visit_nodes([&](const NodeView& node) {
    close_to(node.depth);
    const auto place = static_cast<uint32_t>(visited_.size());
    path.push_back(place);
    visited_.push_back({node.bounds, 0, node.is_leaf ? static_cast<uint32_t>(node.slots.size()) : 1});
    for (const LeafSlot& slot : node.slots) held_.emplace_back(place, numbers_.number(slot));
  });
  close_to(0);
}

void FlatTree::add(uint32_t node) {
  place_[node] = static_cast<uint32_t>(nodes_.size());
  nodes_.push_back(visited_[node]);
  const size_t begin = waiting_.size();
  for (uint32_t child = node + 1; child < visited_[node].end; child = visited_[child].end) waiting_.push_back(child);
  add_siblings(begin, waiting_.size());
  waiting_.resize(begin);
  nodes_[place_[node]].end = static_cast<uint32_t>(nodes_.size());
}

/// Adds waiting_[begin, end).
void FlatTree::add_siblings(size_t begin, size_t end) {
  size_t group = 1;
  while (group * kMostSiblings < end - begin) group *= kMostSiblings;
  for (size_t i = begin; i < end; i += group) {
    if (group == 1) {
      add(waiting_[i]);
      continue;
    }
    const size_t group_end = std::min(end, i + group);
    FlatNode around;
    for (size_t k = i; k < group_end; ++k) around.bounds.extend(visited_[waiting_[k]].bounds);
    const size_t place = nodes_.size();
    nodes_.push_back(around);
    add_siblings(i, group_end);
    nodes_[place].end = static_cast<uint32_t>(nodes_.size());
  }
}

void FlatTree::sum_subtrees() {
  subtrees_.resize(nodes_.size());
  for (size_t i = nodes_.size(); i-- > 0;) {
    Subtree sum{nodes_[i].bounds, static_cast<double>(nodes_[i].cost)};
    for (size_t child = i + 1; child < nodes_[i].end; child = nodes_[child].end) {
      sum.shared = intersected(sum.shared, subtrees_[child].shared);
      sum.cost += subtrees_[child].cost;
    }
    subtrees_[i] = sum;
  }
}

double FlatTree::overlap(size_t primitive, const Surface& surface, const WorkLimit& limit) const {
  const std::span<const uint32_t> leaves = std::span(leaves_).subspan(
      first_reference_[primitive], first_reference_[primitive + 1] - first_reference_[primitive]);
  double sum = 0;
  size_t next_leaf = 0;  // the first of `leaves` that the walk has not passed
  uint32_t steps = 0;
  for (uint32_t i = 0; i < nodes_.size();) {
    if (++steps % kStepsToCheck == 0) limit.check();
    const FlatNode& node = nodes_[i];
    if (!surface.is_near(node.bounds)) {
      i = node.end;
      continue;
    }
    while (next_leaf < leaves.size() && leaves[next_leaf] < i) ++next_leaf;
    const bool is_held = next_leaf < leaves.size() && leaves[next_leaf] < node.end;
    if (!is_held) {
      const bool is_within = surface.is_within(node.bounds);
      if (is_within && surface.is_within(subtrees_[i].shared)) {
        sum += subtrees_[i].cost * surface.area;
        i = node.end;
        continue;
      }
      const double area = is_within                          ? surface.area
                          : surface.plane_meets(node.bounds) ? surface.area_within(node.bounds)
                                                             : 0;
      sum += node.cost * area;
      if (area == 0) {  // children lie within their parent
        i = node.end;
        continue;
      }
    }
    ++i;
  }
  return sum;
}

}  // namespace

double end_point_overlap(const Scene& scene, const WorkLimit& limit) {
  const StandardFloat standard;
  const FlatTree tree(scene, limit);
  const size_t blocks = (tree.primitives() + kPrimitiveBlock - 1) / kPrimitiveBlock;
  std::vector<double> areas(blocks), overlaps(blocks);
  parallel_for(tree.primitives(), kPrimitiveBlock, [&](size_t begin, size_t end) {
    limit.check();
    for (size_t i = begin; i < end; ++i) {
      const Surface surface(tree.polygon(i));
      if (surface.polygon.size == 0) continue;
      areas[begin / kPrimitiveBlock] += surface.area;
      overlaps[begin / kPrimitiveBlock] += tree.overlap(i, surface, limit);
    }
  });
  const double area = std::accumulate(areas.begin(), areas.end(), 0.0);
  return area > 0 ? std::accumulate(overlaps.begin(), overlaps.end(), 0.0) / area : 0;
}

}  // namespace kerf
