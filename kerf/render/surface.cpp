#include "kerf/render/surface.h"

#include <algorithm>
#include <cmath>

#include "kerf/geometry/ray_sphere.h"
#include "kerf/render/frame.h"

namespace kerf {

SurfacePoint triangle_point(const Triangle& triangle, double u, double v) {
  const Vec3d a = to_double(triangle.a), b = to_double(triangle.b), c = to_double(triangle.c);
  SurfacePoint point;
  point.position = a * (1 - u - v) + b * u + c * v;
  point.normal = normalized(cross(b - a, c - a));
  point.extent = largest(max(max(abs(a), abs(b)), abs(c)));
  return point;
}

SurfacePoint parallelogram_point(const Parallelogram& shape, double u, double v) {
  const auto corners = shape.corners();
  const Vec3d a = to_double(cleaned(shape.u)), b = to_double(cleaned(shape.v));
  SurfacePoint point;
  point.position = corners[0] + a * u + b * v;
  point.normal = normalized(cross(a, b));
  for (const Vec3d& corner : corners) point.extent = std::max(point.extent, largest(abs(corner)));
  return point;
}

SurfacePoint sphere_point(const Sphere& sphere, Vec3d outward) {
  const Vec3d center = to_double(cleaned(sphere.center));
  SurfacePoint point;
  point.normal = normalized(outward);
  point.position = center + point.normal * double{sphere.radius};
  point.extent = largest(abs(center)) + sphere.radius;
  return point;
}

SurfacePoint hit_point(const Geometry& geometry, const Ray& ray, const Hit& hit) {
  if (const auto* mesh = std::get_if<TriangleMesh>(&geometry.shapes)) {
    return triangle_point(mesh->triangle(hit.primitive), hit.u, hit.v);
  }
  if (const auto* shapes = std::get_if<Strided<Parallelogram>>(&geometry.shapes)) {
    return parallelogram_point((*shapes)[hit.primitive], hit.u, hit.v);
  }
  const Sphere sphere = std::get<Strided<Sphere>>(geometry.shapes)[hit.primitive];
  // Of the two ways to say where the hit is, the one with less rounding: t for near ones, u and v for far ones.
  const Vec3d to_hit = to_double(ray.origin) - to_double(sphere.center) + to_double(ray.direction) * double{hit.t};
  return sphere_point(sphere, hit.t < sphere.radius ? to_hit : detail::from_octahedral(hit.u, hit.v));
}

Vec3f offset_origin(const SurfacePoint& point, Vec3f direction) {
  // Two roundings to float of half a unit in the last place each, doubled to be safe, and the error in double of what
  // the position was computed from.
  const Vec3d normal = dot(to_double(direction), point.normal) < 0 ? -point.normal : point.normal;
  const double in_double = 0x1p-48 * point.extent + 0x1p-140;
  const Vec3d error = abs(point.position) * 0x1p-22 + Vec3d{in_double, in_double, in_double};
  return to_float(point.position + normal * (1.001 * dot(abs(normal), error)));
}

}  // namespace kerf
