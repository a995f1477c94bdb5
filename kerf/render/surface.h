#pragma once

#include "kerf/base/vec3.h"
#include "kerf/geometry/geometry.h"
#include "kerf/geometry/hit.h"
#include "kerf/geometry/ray.h"
#include "kerf/io/material.h"

namespace kerf {

/// A point on a primitive, as exact as double is, with a bound on what is left.
struct SurfacePoint {
  Vec3d position;
  Vec3d normal;       ///< unit: by the right hand around a triangle's corners, along u x v, outward from a sphere
  double extent = 0;  ///< no coordinate that `position` was computed from is larger
};

SurfacePoint triangle_point(const Triangle& triangle, double u, double v);
SurfacePoint parallelogram_point(const Parallelogram& shape, double u, double v);
/// The point in a direction from the sphere's centre, of any length.
SurfacePoint sphere_point(const Sphere& sphere, Vec3d outward);

/// Where a ray hit a primitive, from its shape: the ray and t are not exact enough to start another ray from.
SurfacePoint hit_point(const Geometry& geometry, const Ray& ray, const Hit& hit);

/// The origin of a ray that leaves a surface to the side of `direction`: the nearest floats to the point, moved along
/// the normal by as much as the error of the position and its rounding can be, so that the ray does not meet the
/// primitive that it leaves, at any scale (Pharr, Jakob, Humphreys, "Physically Based Rendering", 3.9).
Vec3f offset_origin(const SurfacePoint& point, Vec3f direction);

/// A point and all that its shading depends on.
struct Surface {
  SurfacePoint point;
  Vec3f geometric_normal;  ///< of the primitive, on the side of the shading normal
  Vec3f shading_normal;    ///< interpolated where a mesh has normals
  Vec3f albedo;            ///< of the material, with its texture
  const Material* material = nullptr;
};

}  // namespace kerf
