#include "tests/support/structure_check.h"

#include <map>
#include <utility>
#include <vector>

namespace kerf::test {
namespace {

/// Some points of a primitive, in double.
std::vector<Vec3d> points_of(const Geometry& geometry, uint32_t primitive) {
  std::vector<Vec3d> points;
  const auto add_grid = [&](Vec3d origin, Vec3d u, Vec3d v, bool is_triangle) {
    constexpr int kSteps = 4;
    for (int i = 0; i <= kSteps; ++i) {
      for (int k = 0; k <= (is_triangle ? kSteps - i : kSteps); ++k) {
        points.push_back(origin + u * (static_cast<double>(i) / kSteps) + v * (static_cast<double>(k) / kSteps));
      }
    }
  };
  if (const auto* mesh = std::get_if<TriangleMesh>(&geometry.shapes)) {
    const Triangle t = mesh->triangle(primitive);
    const Vec3d a = to_double(t.a);
    add_grid(a, to_double(t.b) - a, to_double(t.c) - a, true);
  } else if (const auto* shapes = std::get_if<Strided<Parallelogram>>(&geometry.shapes)) {
    const Parallelogram& p = (*shapes)[primitive];
    add_grid(to_double(p.corner), to_double(p.u), to_double(p.v), false);
  } else {
    const Sphere& s = std::get<Strided<Sphere>>(geometry.shapes)[primitive];
    for (uint32_t axis = 0; axis < 3; ++axis) {
      for (const double side : {-1.0, 1.0}) {
        Vec3d p = to_double(s.center);
        p[axis] += side * double{s.radius};
        points.push_back(p);
      }
    }
  }
  return points;
}

using Places = std::map<std::pair<uint32_t, uint32_t>, std::vector<Box3f>>;

bool is_inside(const Box3f& box, Vec3d p, double slack) {
  for (uint32_t axis = 0; axis < 3; ++axis) {
    if (p[axis] < double{box.lower[axis]} - slack || p[axis] > double{box.upper[axis]} + slack) return false;
  }
  return true;
}

}  // namespace

std::optional<std::string> find_outer_fault(const Structure& structure, std::span<const Geometry> geometries) {
  std::optional<std::string> fault;
  std::vector<Box3f> path;
  Places places;
  structure.visit_nodes([&](const NodeView& node) {
    if (fault) return;
    if (node.depth > path.size()) {
      fault = "a node's depth jumps";
      return;
    }
    path.resize(node.depth);
    if (!path.empty() && !path.back().contains(node.bounds)) fault = "a child outside its parent's box";
    path.push_back(node.bounds);
    for (const LeafSlot& slot : node.slots) places[{slot.geometry(), slot.primitive}].push_back(node.bounds);
  });
  if (fault) return fault;
  for (uint32_t g = 0; g < geometries.size(); ++g) {
    for (uint32_t p = 0; p < primitive_count(geometries[g]); ++p) {
      if (find_defect(geometries[g], p) != Defect::none || is_degenerate(geometries[g], p)) continue;
      const std::string name = "geometry " + std::to_string(g) + ", primitive " + std::to_string(p);
      const auto found = places.find({g, p});
      if (found == places.end()) return name + " is in no leaf";
      // Clipped boxes are rounded outward, the points here are off by a rounding in double.
      const Box3f bounds = primitive_bounds(geometries[g], p);
      const double slack = 0x1p-45 * (largest(abs(to_double(bounds.lower))) + largest(abs(to_double(bounds.upper))));
      for (const Vec3d point : points_of(geometries[g], p)) {
        bool is_covered = false;
        for (const Box3f& box : found->second) is_covered = is_covered || is_inside(box, point, slack);
        if (!is_covered) return name + " reaches out of the leaves that have it";
      }
    }
  }
  return std::nullopt;
}

std::optional<std::string> find_outer_fault(const Scene& scene) {
  return find_outer_fault(scene.structure(), scene.geometries());
}

}  // namespace kerf::test
