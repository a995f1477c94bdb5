#pragma once

#include <algorithm>
#include <cmath>

#include "kerf/trace/ray_box.h"
#include "kerf/tree/uniform_grid.h"

namespace kerf {

/// The cells of a uniform grid along a ray, nearest first (3D-DDA: Amanatides, Woo: A Fast Voxel Traversal Algorithm
/// for Ray Tracing, 1987; Cleary, Wyvill 1988), and no cell is missed that BoxRay enters.
///
/// A ray that is as thick as its error is in more than one slab of an axis while it crosses the plane between them. So
/// each axis has a first and a last slab that the ray is in, and the cells that it is in are their product. Whenever it
/// enters a slab of one axis, the cells of that slab with what it is in along the others are new. Each crossing is
/// computed from its plane, as BoxRay does it, not from the one before: nothing adds up, and the cells visited are
/// exactly those that BoxRay enters.
class GridWalk {
 public:
  /// `entry`: where the ray enters the grid's bounds, within its interval.
  GridWalk(const UniformGrid& grid, const PreparedRay& ray, const BoxRay& box_ray, float entry) {
    ptrdiff_t stride = 1;
    for (uint32_t a = 0; a < 3; ++a) {
      axes_[a] = Slabs(grid.planes[a], box_ray, a, ray.direction_d[a] < 0, stride);
      exit_ = std::min(exit_, axes_[a].exit(axes_[a].count - 1));
      stride *= axes_[a].count;
    }
    for (uint32_t a = 0; a < 3; ++a) {
      const double at = ray.origin_d[a] + double{entry} * ray.direction_d[a];
      axes_[a].start(entry, at, grid.planes[a]);
    }
  }

  /// Calls visit(number) for each cell that the ray is in before or at `limit`, which visit may lower; stops where it
  /// returns false, and then returns false.
  template <class Visit>
  bool run(const float& limit, Visit&& visit) {
    if (!visit_range(axes_[2].first, axes_[2].last, axes_[0].first, axes_[0].last, axes_[1].first, axes_[1].last, 2, 0,
                     1, visit)) {
      return false;
    }
    while (true) {
      const uint32_t xy = axes_[0].next_entry <= axes_[1].next_entry ? 0 : 1;
      const uint32_t a = axes_[xy].next_entry <= axes_[2].next_entry ? xy : 2;
      const float t = axes_[a].next_entry;
      if (!(t <= limit && t <= exit_ && t < kInfinity)) return true;
      if (!(a == 0 ? step<0>(t, visit) : a == 1 ? step<1>(t, visit) : step<2>(t, visit))) return false;
    }
  }

 private:
  static constexpr float kInfinity = Box3f::kInfinity;

  /// The slabs of one axis, numbered in the order in which the ray comes to them.
  struct Slabs {
    const float* plane = nullptr;  ///< the near side of slab 0; that of slab k lies k * step further
    ptrdiff_t step = 1;
    ptrdiff_t cell_first = 0, cell_step = 1;  ///< what slab k adds to a cell's number
    float origin_near = 0, origin_far = 0, inverse = 0;
    uint32_t count = 0;
    uint32_t first = 0, last = 0;  ///< the slabs that the ray is in
    float first_exit = 0;          ///< where it leaves `first`, at the latest
    float next_entry = 0;          ///< where it enters the slab after `last`, at the earliest; infinite after all

    Slabs() = default;
    Slabs(const std::vector<float>& planes, const BoxRay& ray, uint32_t a, bool negative, ptrdiff_t stride)
        : plane(negative ? &planes.back() : planes.data()),
          step(negative ? -1 : 1),
          cell_first(negative ? stride * static_cast<ptrdiff_t>(planes.size() - 2) : 0),
          cell_step(negative ? -stride : stride),
          origin_near(ray.origin_near[a]),
          origin_far(ray.origin_far[a]),
          inverse(ray.inverse[a]),
          count(static_cast<uint32_t>(planes.size()) - 1) {}

    /// As in BoxRay, a NaN from 0 * infinity bounds nothing.
    float entry(uint32_t k) const {
      const float t = (plane[step * static_cast<ptrdiff_t>(k)] - origin_near) * inverse;
      return t > -kInfinity ? t : -kInfinity;
    }
    float exit(uint32_t k) const {
      const float t = (plane[step * (static_cast<ptrdiff_t>(k) + 1)] - origin_far) * inverse;
      return t < kInfinity ? t : kInfinity;
    }
    ptrdiff_t cell_part(uint32_t k) const { return cell_first + cell_step * static_cast<ptrdiff_t>(k); }

    /// The slabs that the ray is in at t, from a guess by its position there.
    void start(float t, double at, const std::vector<float>& planes) {
      const double share = (at - planes.front()) / (double{planes.back()} - planes.front());
      const double guess = (step > 0 ? share : 1 - share) * count;
      first = guess >= 1 ? static_cast<uint32_t>(std::min(guess, count - 1.0)) : 0;
      while (first > 0 && exit(first - 1) >= t) --first;
      while (first < count - 1 && exit(first) < t) ++first;
      last = first;
      while (last < count - 1 && entry(last + 1) <= t) ++last;
      first_exit = exit(first);
      next_entry = last + 1 < count ? entry(last + 1) : kInfinity;
    }
    void enter_next() {
      ++last;
      next_entry = last + 1 < count ? entry(last + 1) : kInfinity;
    }
    void leave_before(float t) {
      while (first_exit < t && first < last) first_exit = exit(++first);
    }
  };

  /// Enters the next slab along axis kA, at t.
  template <uint32_t kA, class Visit>
  bool step(float t, Visit&& visit) {
    constexpr uint32_t kB = (kA + 1) % 3, kC = (kA + 2) % 3;
    Slabs &a = axes_[kA], &b = axes_[kB], &c = axes_[kC];
    a.enter_next();
    b.leave_before(t);
    c.leave_before(t);
    if (b.first == b.last && c.first == c.last) {
      return visit(static_cast<size_t>(a.cell_part(a.last) + b.cell_part(b.last) + c.cell_part(c.last)));
    }
    return visit_range(a.last, a.last, b.first, b.last, c.first, c.last, kA, kB, kC, visit);
  }

  template <class Visit>
  bool visit_range(uint32_t a_first, uint32_t a_last, uint32_t b_first, uint32_t b_last, uint32_t c_first,
                   uint32_t c_last, uint32_t a, uint32_t b, uint32_t c, Visit&& visit) {
    for (uint32_t i = a_first; i <= a_last; ++i) {
      for (uint32_t j = b_first; j <= b_last; ++j) {
        const ptrdiff_t row = axes_[a].cell_part(i) + axes_[b].cell_part(j);
        for (uint32_t k = c_first; k <= c_last; ++k) {
          if (!visit(static_cast<size_t>(row + axes_[c].cell_part(k)))) return false;
        }
      }
    }
    return true;
  }

  Slabs axes_[3];
  float exit_ = kInfinity;
};

}  // namespace kerf
