#include "kerf/geometry/geometry.h"

#include "kerf/geometry/clip.h"
#include "kerf/geometry/ray_parallelogram.h"
#include "kerf/geometry/ray_sphere.h"
#include "kerf/geometry/ray_triangle.h"

namespace kerf {
namespace {

template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;  // clang 14 does not find it by itself

Box3f bounds_of(const Triangle& t) { return {min(min(t.a, t.b), t.c), max(max(t.a, t.b), t.c)}; }
Box3f bounds_of(const Parallelogram& p) {
  const std::array<Vec3d, 4> c = p.corners();
  return outward(min(min(c[0], c[1]), min(c[2], c[3])), max(max(c[0], c[1]), max(c[2], c[3])));
}
Box3f bounds_of(const Sphere& s) {
  const Vec3d center = to_double(cleaned(s.center)), reach{s.radius, s.radius, s.radius};
  return outward(center - reach, center + reach);
}

std::array<Vec3d, 3> corners_of(const Triangle& t) { return {to_double(t.a), to_double(t.b), to_double(t.c)}; }

Box3f clip_to(const Triangle& t, const Box3f& cell) { return clipped_bounds(corners_of(t), cell); }
Box3f clip_to(const Parallelogram& p, const Box3f& cell) { return clipped_bounds(p.corners(), cell); }
Box3f clip_to(const Sphere& s, const Box3f& cell) { return clipped_bounds(s, cell); }

CutBounds cut_at(const Triangle& t, const Box3f& cell, uint32_t axis, float position) {
  return cut_bounds(corners_of(t), cell, axis, position);
}
CutBounds cut_at(const Parallelogram& p, const Box3f& cell, uint32_t axis, float position) {
  return cut_bounds(p.corners(), cell, axis, position);
}
CutBounds cut_at(const Sphere& s, const Box3f& cell, uint32_t axis, float position) {
  Box3f below = cell, above = cell;
  below.upper[axis] = position;
  above.lower[axis] = position;
  return {clipped_bounds(s, below), clipped_bounds(s, above)};
}

Defect defect_of(const Parallelogram& p) {
  // The far corner must stay in range too.
  const bool far_corner =
      is_coordinate(p.corner + p.u) && is_coordinate(p.corner + p.v) && is_coordinate(p.corner + p.u + p.v);
  return is_coordinate(p.corner) && is_coordinate(p.u) && is_coordinate(p.v) && far_corner ? Defect::none
                                                                                           : Defect::bad_coordinate;
}
Defect defect_of(const Sphere& s) {
  if (!is_coordinate(s.center)) return Defect::bad_coordinate;
  if (!(s.radius >= 0) || !is_coordinate(s.radius)) return Defect::bad_radius;
  return Defect::none;
}

Vec3d normal_of(const Triangle& t) { return cross(to_double(t.b) - to_double(t.a), to_double(t.c) - to_double(t.a)); }
Vec3d normal_of(const Parallelogram& p) { return cross(to_double(p.u), to_double(p.v)); }

/// Calls f with the shape itself: Triangle, Sphere or Parallelogram.
template <class F>
auto with_shape(const Geometry& geometry, uint32_t primitive, F&& f) {
  if (const auto* mesh = std::get_if<TriangleMesh>(&geometry.shapes)) return f(mesh->triangle(primitive));
  if (const auto* spheres = std::get_if<Strided<Sphere>>(&geometry.shapes)) return f((*spheres)[primitive]);
  return f((*std::get_if<Strided<Parallelogram>>(&geometry.shapes))[primitive]);
}

}  // namespace

std::string_view kind_name(const Geometry& geometry) {
  constexpr std::string_view kNames[] = {"triangle", "sphere", "parallelogram"};
  return kNames[geometry.shapes.index()];
}

size_t primitive_count(const Geometry& geometry) {
  return std::visit(Overloaded{[](const TriangleMesh& mesh) { return mesh.triangles.size(); },
                               [](const auto& shapes) { return shapes.size(); }},
                    geometry.shapes);
}

Box3f primitive_bounds(const Geometry& geometry, uint32_t primitive) {
  return with_shape(geometry, primitive, [](const auto& shape) { return bounds_of(shape); });
}

Box3f clipped_bounds(const Geometry& geometry, uint32_t primitive, const Box3f& cell) {
  return with_shape(geometry, primitive, [&](const auto& shape) { return clip_to(shape, cell); });
}

CutBounds cut_bounds(const Geometry& geometry, uint32_t primitive, const Box3f& cell, uint32_t axis, float position) {
  return with_shape(geometry, primitive, [&](const auto& shape) { return cut_at(shape, cell, axis, position); });
}

Defect find_defect(const Geometry& geometry, uint32_t primitive) {
  if (const auto* mesh = std::get_if<TriangleMesh>(&geometry.shapes)) {
    // The indices must be judged before a vertex is read.
    for (const uint32_t k : mesh->triangles[primitive]) {
      if (k >= mesh->vertices.size()) return Defect::bad_index;
      if (!is_coordinate(mesh->vertices[k])) return Defect::bad_coordinate;
    }
    return Defect::none;
  }
  return with_shape(
      geometry, primitive,
      Overloaded{[](const Triangle&) { return Defect::none; }, [](const auto& shape) { return defect_of(shape); }});
}

bool is_degenerate(const Geometry& geometry, uint32_t primitive) {
  return with_shape(geometry, primitive, [](const auto& shape) { return is_degenerate(shape); });
}

bool intersect(const Geometry& geometry, uint32_t primitive, const PreparedRay& ray, float limit, Crossing& crossing) {
  return with_shape(geometry, primitive, [&](const auto& shape) { return intersect(ray, shape, limit, crossing); });
}

Vec3f unit_normal(const Geometry& geometry, uint32_t primitive, float u, float v) {
  const Vec3d normal = with_shape(geometry, primitive,
                                  Overloaded{[&](const Sphere&) { return detail::from_octahedral(u, v); },
                                             [](const auto& shape) { return normal_of(shape); }});
  // Scaled first, or the squares of coordinates near 1e30 and 1e-30 leave the range.
  const double scale = largest(abs(normal));
  if (!(scale > 0)) return {};
  const Vec3d scaled = normal / scale;
  return to_float(scaled / std::sqrt(dot(scaled, scaled)));
}

}  // namespace kerf
