// No include guard on purpose: a part of trace_wide.cpp, which includes it once for each instruction set, in
// HWY_NAMESPACE.

/// A ray's tests of leaves.
template <class Tree, bool kAny, class Counts>
class LeafVisits {
  using Tracer = WideTracer<typename Tree::Layout>;
  using Child = typename Tree::Child;
  using Leaf = typename Tree::Leaf;

 public:
  LeafVisits(const Tracer& tracer, const Ray& ray, const WideRay& wide, NearestHit& nearest, Counts& counts)
      : tracer_(tracer), ray_(ray), wide_(wide), nearest_(nearest), counts_(counts) {}

  /// Whether the ray's way is over: any hit is enough.
  HWY_INLINE bool test(Child leaf) {
    if (leaf.kind() == Child::kSlots) return test_slots(tracer_, ray_, wide_, nearest_, counts_, leaf);
    const Leaf triangles = tracer_.layout.triangles(leaf);
    if constexpr (Counts::kCounts) {
      for (const LeafSlot& slot : tracer_.layout.slots(leaf)) counts_.count_primitives(std::span(&slot, 1));
    }
    Between between;
    const Found found = typename Tree::Leaves{wide_}.find(triangles, nearest_.hit.t, between);
    if (found.maybe == 0) return false;
    if ((tracer_.shared_mask & ray_.mask) != 0) {
      if constexpr (kAny) {
        if (found.sure != 0) {
          nearest_.hit.primitive = 0;  // some primitive
          return true;
        }
      } else if (found.sure == found.maybe && take_nearest(leaf, found.sure, between)) {
        return false;
      }
    }
    return test_triangles(tracer_, ray_, wide_, nearest_, triangles, found.maybe);
  }

  /// Works the hit out that is to be, if any.
  static HWY_INLINE void resolve(const Tracer& tracer, const Ray& ray, const WideRay& wide, NearestHit& nearest) {
    if (nearest.leaf == 0) return;
    const Leaf triangles = tracer.layout.triangles(Child{nearest.leaf});
    const LeafSlot slot = triangles.slot(nearest.number);
    Crossing crossing;
    [[maybe_unused]] const bool is_hit =
        ExactTest(ray, wide).hits(triangles, nearest.number, wide, nearest.hit.t, crossing);
    assert(is_hit && crossing.t >= nearest.least);
    nearest.hit = {crossing.t, crossing.u, crossing.v, slot.primitive, slot.geometry(), kNone};
    nearest.least = crossing.t;
    nearest.leaf = 0;
  }

  /// The triangles of `found`, exactly. Whether the walk is over.
  static HWY_NOINLINE bool test_triangles(const Tracer& tracer, const Ray& ray, const WideRay& wide,
                                          NearestHit& nearest, const Leaf& triangles, uint32_t found) {
    resolve(tracer, ray, wide, nearest);
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
  HWY_INLINE bool take_nearest(Child leaf, uint32_t sure, const Between& between) {
    do {
      const auto i = static_cast<uint32_t>(std::countr_zero(sure));
      if (between.most[i] < nearest_.least) {
        nearest_.hit.t = between.most[i];
        nearest_.least = between.least[i];
        nearest_.leaf = leaf.word;
        nearest_.number = i;
      } else if (between.least[i] <= nearest_.hit.t) {
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

  const Tracer& tracer_;
  const Ray& ray_;
  const WideRay& wide_;
  NearestHit& nearest_;
  Counts& counts_;
};
