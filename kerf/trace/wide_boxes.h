// No include guard on purpose: a part of trace_wide.cpp, which includes it once for each instruction set, in
// HWY_NAMESPACE.

/// What the box tests need of a ray, in registers. Usual: as of WideRay::is_usual.
template <uint32_t kWidth, bool kUsual>
struct BoxTests {
  using Lanes = hn::CappedTag<float, kWidth>;
  using V = hn::Vec<Lanes>;

  V near_x, near_y, near_z, far_x, far_y, far_z;  ///< origins
  V inverse_near_x, inverse_near_y, inverse_near_z, inverse_far_x, inverse_far_y, inverse_far_z;
  V t_off;  ///< by which the near sides are nearer and the far ones farther; nothing where the origin is moved by all
  V t_min;
  const SideRows& rows;

  explicit BoxTests(const WideRay& ray)
      : t_off(all(kUsual ? ray.t_off : 0)), t_min(all(ray.t_min)), rows(kSideRows<kWidth, 2>.by_octant[ray.octant]) {
    set(kUsual ? ray.origin_near : ray.origin_near_moved(), near_x, near_y, near_z);
    set(kUsual ? ray.origin_far : ray.origin_far_moved(), far_x, far_y, far_z);
    set(kUsual ? ray.inverse_near : ray.inverse, inverse_near_x, inverse_near_y, inverse_near_z);
    set(kUsual ? ray.inverse_far : ray.inverse, inverse_far_x, inverse_far_y, inverse_far_z);
  }

  /// Which children the ray enters within [t_min, limit], as bits, and where.
  HWY_INLINE uint32_t enter(const WideNode<kWidth>& node, float limit, float* entry) const {
    uint32_t entered = 0;
    test(node, limit, [&](uint32_t i, V near, uint32_t some) {
      hn::Store(near, Lanes(), entry + i);
      entered |= some << i;
    });
    return entered;
  }

  /// The key of the child to go on with, ChildKey::kNone if none is entered; the others' are put on top.
  template <bool kAny>
  HWY_INLINE uint64_t take(const WideNode<kWidth>& node, float limit, uint64_t*& top) const {
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3
    uint64_t taken = 0;
    test(node, limit, [&](uint32_t, V near, uint32_t entered) {
      const VectorKeys<kWidth> keys(&node.child[0].word, near, entered);
      taken = kAny ? keys.take_first(&node.child[0].word, top) : keys.take_nearest(top);
    });
    return taken;
#else
    HWY_ALIGN float entry[kWidth];
    const uint32_t entered = enter(node, limit, entry);
    return kAny ? take_first(&node.child[0].word, entry, entered, top)
                : take_nearest(&node.child[0].word, entry, entered, top);
#endif
  }

 private:
  /// Calls f(first, where, which) of children that a vector has room for at a time, from the first on.
  template <class F>
  HWY_INLINE void test(const WideNode<kWidth>& node, float limit, F&& f) const {
    const Lanes d;
    const float* const sides = &node.sides[0][0][0];
    for (uint32_t i = 0; i < kWidth; i += hn::MaxLanes(d)) {
      const auto x0 = near_t(sides + rows.near[0] + i, near_x, inverse_near_x),
                 x1 = far_t(sides + rows.far[0] + i, far_x, inverse_far_x);
      const auto y0 = near_t(sides + rows.near[1] + i, near_y, inverse_near_y),
                 y1 = far_t(sides + rows.far[1] + i, far_y, inverse_far_y);
      const auto z0 = near_t(sides + rows.near[2] + i, near_z, inverse_near_z),
                 z1 = far_t(sides + rows.far[2] + i, far_z, inverse_far_z);
      V near;
      const uint32_t entered = overlap<kUsual>(d, {x0, y0, z0, t_min}, {x1, y1, z1, hn::Set(d, limit)}, near);
      f(i, near, entered);
    }
  }

  static HWY_INLINE V all(float value) { return hn::Set(Lanes(), value); }
  static HWY_INLINE void set(Float4 values, V& x, V& y, V& z) {
    x = all(values[0]);
    y = all(values[1]);
    z = all(values[2]);
  }
  // The difference the other way round: so that a processor may take the side from memory.
  HWY_INLINE V near_t(const float* sides, V origin, V inverse) const {
    return hn::NegMulSub(hn::Sub(origin, hn::Load(Lanes(), sides)), inverse, t_off);
  }
  HWY_INLINE V far_t(const float* sides, V origin, V inverse) const {
    return hn::NegMulAdd(hn::Sub(origin, hn::Load(Lanes(), sides)), inverse, t_off);
  }
};
