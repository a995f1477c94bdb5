#include "kerf/trace/trace_bsp.h"

#include <cassert>
#include <cmath>
#include <limits>

#include "kerf/base/fp_environment.h"
#include "kerf/trace/leaf.h"

namespace kerf {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A cell that waits for its turn, with the part of the ray that lies in it.
struct Waiting {
  uint32_t node;
  double entry, exit;
};

/// Where a ray may be below and above a plane, so that no cell is missed that holds a hit.
///
/// A hit at the float t lies within t's rounding, 2 e M with e = 2^-24 and M the distance from the origin to the
/// farthest side of the scene, of a point of the primitive along each axis, and that point within the tree's slack of
/// the leaf's side of each plane. So planes are moved by `margin`, which is more than both and the rounding in double,
/// some 2^-49 M, on top: a cell may be visited that need not be, none is missed that must be.
class PlaneRay {
 public:
  PlaneRay(const PreparedRay& ray, const Box3f& bounds, double slack)
      : origin_(ray.origin_d), direction_(ray.direction_d) {
    const Vec3d below = abs(to_double(bounds.lower) - origin_), above = abs(to_double(bounds.upper) - origin_);
    margin_ = slack + 0x1p-20 * largest(max(below, above));
  }

  struct Crossing {
    uint32_t near;     ///< 0: the ray comes from below the plane, 1: from above
    double near_exit;  ///< where it leaves the near side, at the latest
    double far_entry;  ///< where it enters the far side, at the earliest
  };

  /// `along`: the direction's part across the plane; `height`: the plane's distance from the origin.
  Crossing cross(double along, double height) const {
    if (along == 0) return {0, height >= -margin_ ? kInfinity : -kInfinity, height <= margin_ ? -kInfinity : kInfinity};
    const double inverse = 1 / std::abs(along), ahead = along < 0 ? -height : height;
    return {along < 0 ? 1U : 0U, (ahead + margin_) * inverse, (ahead - margin_) * inverse};
  }
  Crossing cross(const BspNode& node) const {
    if (node.kind != BspPlane::kOblique) return cross(direction_[node.kind], node.offset - origin_[node.kind]);
    const Vec3d normal = to_double(node.normal);
    return cross(dot(normal, direction_), node.offset - dot(normal, origin_));
  }

  /// Shortens [entry, exit] to what lies in the box; false where that is nothing.
  bool clip(const Box3f& box, double& entry, double& exit) const {
    for (uint32_t axis = 0; axis < 3; ++axis) {
      const Crossing lower = cross(direction_[axis], box.lower[axis] - origin_[axis]);
      const Crossing upper = cross(direction_[axis], box.upper[axis] - origin_[axis]);
      // The box is above its lower side and below its upper one.
      const double enter = lower.near == 0 ? lower.far_entry : upper.far_entry;
      const double leave = lower.near == 0 ? upper.near_exit : lower.near_exit;
      entry = enter > entry ? enter : entry;
      exit = leave < exit ? leave : exit;
    }
    return entry <= exit;
  }

 private:
  Vec3d origin_, direction_;
  double margin_;
};

}  // namespace

template <bool kAny, class Counts>
Hit BspTracer::trace(const Ray& ray, Counts& counts) const {
  const StandardFloat standard;
  const PreparedRay prepared(ray);
  if (!prepared.valid || tree.nodes.empty()) return {};
  const PlaneRay plane_ray(prepared, tree.bounds, tree.slack);
  Hit best;
  best.t = prepared.t_max;
  Waiting current{0, prepared.t_min, prepared.t_max};
  counts.count_boxes(1);
  if (!plane_ray.clip(tree.bounds, current.entry, current.exit)) return {};
  Waiting stack[kMaxDepth];  // one cell waits for each level above the current one, and there are at most so many
  uint32_t waiting = 0;
  while (true) {
    counts.count_nodes(1);
    const BspNode& node = tree.nodes[current.node];
    if (!node.is_leaf()) {
      const PlaneRay::Crossing crossing = plane_ray.cross(node);
      const Waiting near{node.first + crossing.near, current.entry,
                         crossing.near_exit < current.exit ? crossing.near_exit : current.exit};
      const Waiting far{node.first + 1 - crossing.near,
                        crossing.far_entry > current.entry ? crossing.far_entry : current.entry, current.exit};
      if (near.entry <= near.exit) {
        if (far.entry <= far.exit) {
          assert(waiting < kMaxDepth);
          stack[waiting++] = far;
        }
        current = near;
        continue;
      }
      if (far.entry <= far.exit) {
        current = far;
        if (!(current.entry > best.t)) continue;
      }
    } else {
      for (uint32_t slot = node.first; slot < node.first + node.count; ++slot) {
        if (test_primitive(geometries, tree.slots[slot], prepared, best, counts) && kAny) return best;
      }
    }
    do {
      if (waiting == 0) return finished(best);
      current = stack[--waiting];
    } while (current.entry > best.t);
  }
}

const TraceTable& bsp_table() { return kTraceTable<BspTracer>; }

}  // namespace kerf
