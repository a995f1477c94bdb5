// No include guard on purpose: a part of trace_wide.cpp, which includes it once for each instruction set, in
// HWY_NAMESPACE.

/// What a first look at a leaf came to.
enum class Look {
  kSettled,  ///< nothing is left to do there
  kOver,     ///< nor anywhere else: any hit is enough
  kUnsure,   ///< it is to be tested exactly
};

/// A ray's tests of leaves.
template <class Tree, bool kAny, class Counts>
struct LeafVisits {
  using Tracer = WideTracer<typename Tree::Layout>;
  using Child = typename Tree::Child;
  using Leaf = typename Tree::Leaf;

  const Tracer& tracer;
  const Ray& ray;
  const WideRay& wide;
  NearestHit& nearest;
  Counts& counts;

  /// Without a call. `maybe` gets the triangles to be tested exactly. Nothing is sure of rays that are not usual.
  template <bool kUsual>
  HWY_INLINE Look look(Child leaf, uint32_t& maybe) const {
    if (leaf.kind() == Child::kSlots) return Look::kUnsure;
    const Leaf triangles = tracer.layout.triangles(leaf);
    if constexpr (Counts::kCounts) {
      for (const LeafSlot& slot : tracer.layout.slots(leaf)) counts.count_primitives(std::span(&slot, 1));
    }
    const typename Tree::Leaves leaves{wide};
    if constexpr (!kUsual) {
      maybe = leaves.may_hit(triangles);
      return maybe == 0 ? Look::kSettled : Look::kUnsure;
    }
    Between between;
    const Found found = leaves.find(triangles, nearest.hit.t, between);
    maybe = found.maybe;
    if (found.maybe == 0) return Look::kSettled;
    if ((tracer.shared_mask & ray.mask) == 0) return Look::kUnsure;
    if constexpr (kAny) {
      if (found.sure == 0) return Look::kUnsure;
      nearest.hit.primitive = 0;  // some primitive
      return Look::kOver;
    }
    return found.sure == found.maybe && take_nearest(leaf, found.sure, between) ? Look::kSettled : Look::kUnsure;
  }

  /// What is left to do where look() is unsure. Whether the ray's way is over.
  HWY_INLINE bool finish(Child leaf, uint32_t maybe) const {
    if (leaf.kind() == Child::kSlots) return test_slots(tracer, ray, wide, nearest, counts, leaf);
    return test_triangles(tracer, ray, wide, nearest, tracer.layout.triangles(leaf), maybe);
  }

  /// Both.
  HWY_INLINE bool test(Child leaf) const {
    uint32_t maybe = 0;
    const Look seen = look<true>(leaf, maybe);
    return seen == Look::kUnsure ? finish(leaf, maybe) : seen == Look::kOver;
  }

  /// Works the hit out that is to be, if any.
  static HWY_INLINE void resolve(const Tracer& tracer, const Ray& ray, const WideRay& wide, NearestHit& nearest) {
    if (nearest.leaf == 0) return;
    const Leaf triangles = tracer.layout.triangles(Child{nearest.leaf});
    const LeafSlot slot = triangles.slot(nearest.number);
    const Crossing crossing = ExactTest(ray, wide).crossing(triangles, nearest.number, wide);
    assert(crossing.t >= nearest.least && crossing.t <= nearest.hit.t);
    nearest.hit = {crossing.t, crossing.u, crossing.v, slot.primitive, slot.geometry(), kNone};
    nearest.least = crossing.t;
    nearest.leaf = 0;
  }

  /// The triangles of `found`, exactly. Whether the walk is over.
  static HWY_NOINLINE bool test_triangles(const Tracer& tracer, const Ray& ray, const WideRay& wide,
                                          NearestHit& nearest, const Leaf& triangles, uint32_t found) {
    resolve(tracer, ray, wide, nearest);
    return test_settled(tracer, ray, wide, nearest, triangles, found);
  }

  /// The same where no hit is to be worked out yet, without a call.
  static HWY_INLINE bool test_settled(const Tracer& tracer, const Ray& ray, const WideRay& wide, NearestHit& nearest,
                                      const Leaf& triangles, uint32_t found) {
    const ExactTest exact(ray, wide);
    for (; found != 0; found &= found - 1) {
      const auto i = static_cast<uint32_t>(std::countr_zero(found));
      Crossing crossing;
      if (!exact.hits(triangles, i, wide, nearest.hit.t, crossing)) continue;
      const LeafSlot slot = triangles.slot(i);
      if ((tracer.geometries[slot.geometry()].mask & ray.mask) == 0) continue;
      const Hit hit{crossing.t, crossing.u, crossing.v, slot.primitive, slot.geometry(), kNone};
      if (nearest.hit && !closer(hit, nearest.hit)) continue;
      nearest.hit = hit;
      if (kAny) return true;
    }
    nearest.least = nearest.hit.t;
    return false;
  }

 private:
  /// Of triangles that the ray surely hits. False if it cannot be told which hit is the nearest.
  HWY_INLINE bool take_nearest(Child leaf, uint32_t sure, const Between& between) const {
    do {
      const auto i = static_cast<uint32_t>(std::countr_zero(sure));
      if (between.most[i] < nearest.least) {
        nearest.hit.t = between.most[i];
        nearest.least = between.least[i];
        nearest.leaf = leaf.word;
        nearest.number = i;
      } else if (between.least[i] <= nearest.hit.t) {
        return false;
      }
      sure &= sure - 1;
    } while (sure != 0);
    return true;
  }

  static HWY_NOINLINE bool test_slots(const Tracer& tracer, const Ray& ray, const WideRay& wide, NearestHit& nearest,
                                      Counts& counts, Child leaf) {
    resolve(tracer, ray, wide, nearest);
    const PreparedRay prepared(ray);
    for (const LeafSlot& slot : tracer.layout.slots(leaf)) {
      if (test_primitive(tracer.geometries, slot, prepared, nearest.hit, counts) && kAny) return true;
    }
    nearest.least = nearest.hit.t;
    return false;
  }
};
