#include "kerf/trace/trace_packets.h"

#include <array>
#include <cassert>
#include <limits>
#include <new>
#include <type_traits>

#include "kerf/base/fp_environment.h"
#include "kerf/trace/leaf.h"

namespace kerf {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// One ray of a packet.
struct PacketRay {
  PreparedRay prepared;
  BoxRay box_ray;
  Hit best;

  PacketRay(const Ray& ray, const Box3f& scene_bounds) : prepared(ray), box_ray(prepared, scene_bounds) {
    best.t = prepared.t_max;
  }
  bool enters(const Bvh2Child& child) const {
    float entry;
    return box_ray.enters(child.sides(), prepared.t_min, best.t, entry);
  }
};

/// The rays of a packet that can hit anything, and intervals around all of them.
class Packet {
 public:
  /// Takes valid rays only; false: the ray hits nothing.
  bool add(const Ray& ray, const Box3f& scene_bounds) {
    auto* added = new (&rays_[size_]) Storage(ray, scene_bounds);
    if (!added->ray.prepared.valid) return false;
    ++size_;
    return true;
  }
  uint32_t size() const { return size_; }
  PacketRay& operator[](uint32_t i) { return rays_[i].ray; }
  const PacketRay& operator[](uint32_t i) const { return rays_[i].ray; }

  /// Called when all rays are there.
  void find_intervals() {
    for (uint32_t i = 0; i < size_; ++i) {
      const PacketRay& ray = (*this)[i];
      t_min_ = std::min(t_min_, ray.prepared.t_min);
      for (uint32_t axis = 0; axis < 3; ++axis) {
        const Interval added{ray.box_ray.origin_near[axis], ray.box_ray.origin_far[axis], ray.box_ray.inverse[axis]};
        axes_[axis].extend(added);
        is_coherent_ = is_coherent_ && ray.box_ray.near_side[axis] == (*this)[0].box_ray.near_side[axis];
      }
    }
    find_limits();
  }

  /// The farthest that any ray from each one on may still hit something.
  void find_limits() {
    float limit = -kInfinity;
    for (uint32_t i = size_; i-- > 0;) limits_[i] = limit = std::max(limit, (*this)[i].best.t);
  }

  bool is_coherent() const { return is_coherent_; }

  /// Surely no ray from `first` on enters the box. The same operations as for one ray, on the ends of intervals:
  /// rounding keeps their order, so each ray's entry is at least, and its exit at most, what comes out here.
  bool all_miss(const float* box, uint32_t first) const {
    const Sides& sides = (*this)[0].box_ray;
    float near = t_min_, far = limits_[first];
    for (uint32_t axis = 0; axis < 3; ++axis) {
      const float t_near = axes_[axis].earliest_entry(box[sides.near_side[axis]]);
      const float t_far = axes_[axis].latest_exit(box[sides.far_side[axis]]);
      near = t_near > near ? t_near : near;
      far = t_far < far ? t_far : far;
    }
    return near > far;
  }

 private:
  /// PreparedRay has no default.
  union Storage {
    PacketRay ray;
    Storage() {}  // NOLINT(modernize-use-equals-default): a union with such a member has none
    Storage(const Ray& r, const Box3f& scene_bounds) : ray(r, scene_bounds) {}
  };
  static_assert(std::is_trivially_destructible_v<PacketRay>);

  /// The moved origins and inverse directions of all rays along an axis, where their directions have one sign.
  struct Interval {
    float near_least, near_most, far_least, far_most;
    float inverse_least, inverse_most;

    Interval()
        : near_least(kInfinity),
          near_most(-kInfinity),
          far_least(kInfinity),
          far_most(-kInfinity),
          inverse_least(kInfinity),
          inverse_most(-kInfinity) {}
    Interval(float near, float far, float inverse)
        : near_least(near),
          near_most(near),
          far_least(far),
          far_most(far),
          inverse_least(inverse),
          inverse_most(inverse) {}
    void extend(const Interval& other) {
      near_least = std::min(near_least, other.near_least);
      near_most = std::max(near_most, other.near_most);
      far_least = std::min(far_least, other.far_least);
      far_most = std::max(far_most, other.far_most);
      inverse_least = std::min(inverse_least, other.inverse_least);
      inverse_most = std::max(inverse_most, other.inverse_most);
    }
    /// The least (side - origin) * inverse: the way is the shortest or, where it leads back, the longest, and so is
    /// the inverse.
    float earliest_entry(float side) const {
      if (inverse_most > 0) {
        const float way = side - near_most;
        return way * (way >= 0 ? inverse_least : inverse_most);
      }
      const float way = side - near_least;
      return way * (way <= 0 ? inverse_most : inverse_least);
    }
    float latest_exit(float side) const {
      if (inverse_most > 0) {
        const float way = side - far_least;
        return way * (way >= 0 ? inverse_most : inverse_least);
      }
      const float way = side - far_most;
      return way * (way <= 0 ? inverse_least : inverse_most);
    }
  };

  std::array<Storage, PacketTracer::kLargest> rays_;
  std::array<float, PacketTracer::kLargest> limits_;
  uint32_t size_ = 0;
  Interval axes_[3];
  float t_min_ = kInfinity;
  bool is_coherent_ = true;
};

/// A packet on its way.
template <class Counts>
class PacketWalk {
 public:
  PacketWalk(const Bvh2Tracer& tracer, Packet& packet, Counts& counts)
      : tracer_(tracer), packet_(packet), counts_(counts) {}

  void run() {
    Waiting stack[kMaxDepth + 1];  // one child for each level above the current one, and the current one
    uint32_t waiting = 0;
    stack[waiting++] = {&tracer_.layout.root, 0};
    while (waiting > 0) {
      const Waiting current = stack[--waiting];
      const uint32_t first = first_entering(*current.child, current.first);
      if (first == packet_.size()) continue;
      if (current.child->is_leaf()) {
        test_leaf(*current.child, first);
        continue;
      }
      count_entering(*current.child, first);
      const Bvh2Node& node = tracer_.layout.nodes[current.child->first];
      const uint32_t near = second_is_near(node, packet_[first].prepared) ? 1 : 0;
      assert(waiting + 2 <= kMaxDepth + 1);
      stack[waiting++] = {&node.child[1 - near], first};
      stack[waiting++] = {&node.child[near], first};
    }
  }

 private:
  /// A box that waits for its turn, and the first ray that entered its parent's.
  struct Waiting {
    const Bvh2Child* child;
    uint32_t first;
  };

  /// The first ray from `first` on that enters the box; else the packet's size.
  uint32_t first_entering(const Bvh2Child& child, uint32_t first) {
    counts_.count_boxes(1);
    if (packet_[first].enters(child)) return first;
    if (packet_.is_coherent()) {
      counts_.count_boxes(1);
      if (packet_.all_miss(child.sides(), first)) return packet_.size();
    }
    for (uint32_t i = first + 1; i < packet_.size(); ++i) {
      counts_.count_boxes(1);
      if (packet_[i].enters(child)) return i;
    }
    return packet_.size();
  }

  void count_entering(const Bvh2Child& child, uint32_t first) {
    if constexpr (!std::is_same_v<Counts, NoCounts>) {
      for (uint32_t i = first; i < packet_.size(); ++i) counts_.count_nodes(packet_[i].enters(child) ? 1 : 0);
    }
  }

  /// Which centre comes first along a ray.
  static bool second_is_near(const Bvh2Node& node, const PreparedRay& ray) {
    const Box3f a = node.child[0].bounds(), b = node.child[1].bounds();
    double apart = 0;
    for (uint32_t axis = 0; axis < 3; ++axis) {
      apart += ray.direction_d[axis] * (double{center(b, axis)} - double{center(a, axis)});
    }
    return apart < 0;
  }

  void test_leaf(const Bvh2Child& leaf, uint32_t first) {
    bool is_closer = false;
    for (uint32_t i = first; i < packet_.size(); ++i) {
      PacketRay& ray = packet_[i];
      if (i > first) {
        counts_.count_boxes(1);
        if (!ray.enters(leaf)) continue;
      }
      counts_.count_nodes(1);
      for (uint32_t slot = leaf.first; slot < leaf.first + leaf.count; ++slot) {
        is_closer |= test_primitive(tracer_.geometries, tracer_.layout.slots[slot], ray.prepared, ray.best, counts_);
      }
    }
    if (is_closer) packet_.find_limits();
  }

  const Bvh2Tracer& tracer_;
  Packet& packet_;
  Counts& counts_;
};

}  // namespace

template <class Counts>
void PacketTracer::trace_batch(std::span<const Ray> rays, std::span<Hit> hits, Counts& counts) const {
  const StandardFloat standard;
  for (size_t begin = 0; begin < rays.size(); begin += size) {
    const size_t end = std::min(rays.size(), begin + size);
    Packet packet;
    std::array<size_t, kLargest> place;
    for (size_t i = begin; i < end; ++i) {
      hits[i] = {};
      if (!layout.is_empty() && packet.add(rays[i], layout.root.bounds())) place[packet.size() - 1] = i;
    }
    if (packet.size() == 0) continue;
    packet.find_intervals();
    PacketWalk<Counts>(*this, packet, counts).run();
    for (uint32_t i = 0; i < packet.size(); ++i) hits[place[i]] = finished(packet[i].best);
  }
}

const TraceTable& PacketTracer::table() { return kTraceTable<PacketTracer>; }

}  // namespace kerf
