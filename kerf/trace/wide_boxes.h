// No include guard on purpose: a part of trace_wide.cpp, which includes it once for each instruction set, in
// HWY_NAMESPACE.

/// What the box tests need of a ray, in registers.
template <uint32_t kWidth, bool kFused>
struct BoxTests {
  using Lanes = hn::CappedTag<float, kWidth>;
  using V = hn::Vec<Lanes>;

  V inverse_x, inverse_y, inverse_z;
  /// Fused: what is added to the product; else the moved origin.
  V near_x, near_y, near_z, far_x, far_y, far_z;
  V t_min;
  uint32_t row_x, row_y, row_z;  ///< where a node's near sides begin; the far ones begin at that ^ kWidth

  explicit BoxTests(const WideRay& ray)
      : inverse_x(all(ray.inverse[0])),
        inverse_y(all(ray.inverse[1])),
        inverse_z(all(ray.inverse[2])),
        near_x(all(kFused ? ray.near_offset[0] : ray.origin_near(0))),
        near_y(all(kFused ? ray.near_offset[1] : ray.origin_near(1))),
        near_z(all(kFused ? ray.near_offset[2] : ray.origin_near(2))),
        far_x(all(kFused ? ray.far_offset[0] : ray.origin_far(0))),
        far_y(all(kFused ? ray.far_offset[1] : ray.origin_far(1))),
        far_z(all(kFused ? ray.far_offset[2] : ray.origin_far(2))),
        t_min(all(ray.t_min)),
        row_x(ray.row(0, kWidth)),
        row_y(ray.row(1, kWidth)),
        row_z(ray.row(2, kWidth)) {}

  /// Which children the ray enters within [t_min, limit], and where.
  HWY_INLINE uint32_t enter(const WideNode<kWidth>& node, float limit, float* entry) const {
    const Lanes d;
    const float* const sides = &node.sides[0][0][0];
    uint32_t entered = 0;
    for (uint32_t i = 0; i < kWidth; i += hn::MaxLanes(d)) {
      const auto x0 = at(sides + row_x + i, inverse_x, near_x), x1 = at(sides + (row_x ^ kWidth) + i, inverse_x, far_x);
      const auto y0 = at(sides + row_y + i, inverse_y, near_y), y1 = at(sides + (row_y ^ kWidth) + i, inverse_y, far_y);
      const auto z0 = at(sides + row_z + i, inverse_z, near_z), z1 = at(sides + (row_z ^ kWidth) + i, inverse_z, far_z);
      const auto near = hn::Max(hn::Max(x0, y0), hn::Max(z0, t_min));
      const auto far = hn::Min(hn::Min(x1, y1), hn::Min(z1, hn::Set(d, limit)));
      hn::Store(near, d, entry + i);
      entered |= bits_of(d, hn::Le(near, far)) << i;
    }
    return entered;
  }

 private:
  static HWY_INLINE V all(float value) { return hn::Set(Lanes(), value); }
  static HWY_INLINE V at(const float* sides, V inverse, V shift) {
    const auto side = hn::Load(Lanes(), sides);
    if constexpr (kFused) return hn::MulAdd(side, inverse, shift);
    return hn::Mul(hn::Sub(side, shift), inverse);
  }
};
