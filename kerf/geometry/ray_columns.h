#pragma once

#include <optional>
#include <string>

#include "kerf/geometry/hit.h"
#include "kerf/geometry/ray.h"
#include "kerf/geometry/shapes.h"

namespace kerf {

/// Rays as a column for each component, in the caller's memory, of any stride: arrays of their own, or the fields of
/// records. A stride of 0 gives all rays one value.
///
///     kerf::RayColumns rays{.origin = {x, y, z}, .direction = {dx, dy, dz}};
struct RayColumns {
  Strided<float> origin[3], direction[3];  ///< x, y, z
  Strided<float> t_min, t_max, time;       ///< an empty one: what Ray has
  Strided<uint32_t> mask;                  ///< the same

  size_t size() const { return origin[0].size(); }
  Ray operator[](size_t i) const {
    Ray ray{.origin = {origin[0][i], origin[1][i], origin[2][i]},
            .direction = {direction[0][i], direction[1][i], direction[2][i]}};
    if (t_min.size() > 0) ray.t_min = t_min[i];
    if (t_max.size() > 0) ray.t_max = t_max[i];
    if (time.size() > 0) ray.time = time[i];
    if (mask.size() > 0) ray.mask = mask[i];
    return ray;
  }
};

/// Where hits go, component by component; what is empty is not wanted.
struct HitColumns {
  std::span<float> t, u, v;
  std::span<uint32_t> primitive, geometry, instance;

  void set(size_t i, const Hit& hit) const {
    if (!t.empty()) t[i] = hit.t;
    if (!u.empty()) u[i] = hit.u;
    if (!v.empty()) v[i] = hit.v;
    if (!primitive.empty()) primitive[i] = hit.primitive;
    if (!geometry.empty()) geometry[i] = hit.geometry;
    if (!instance.empty()) instance[i] = hit.instance;
  }
};

/// The first column whose length is not that of the first of origins, in words; those that may be empty are not held
/// against it then.
std::optional<std::string> find_odd_length(const RayColumns& rays);
std::optional<std::string> find_odd_length(const HitColumns& hits, size_t rays);

}  // namespace kerf
