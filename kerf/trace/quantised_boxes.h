// No include guard on purpose: a part of trace_wide.cpp, which includes it once for each instruction set, in
// HWY_NAMESPACE, after BoxTests and LeafTests.

/// The sides of all boxes of a QuantisedNode on one side of one axis, from child `first` on, in steps.
template <class D>
HWY_INLINE hn::Vec<D> steps_of(D d, const uint8_t* sides) {
  return hn::ConvertTo(d, hn::PromoteTo(hn::RebindToSigned<D>(), hn::LoadU(hn::Rebind<uint8_t, D>(), sides)));
}

/// The steps along x, y or z: a part of the word of exponents, where a float has its exponent.
template <int kAxis, class D>
HWY_INLINE hn::Vec<D> step_of(D d, const QuantisedNode& node) {
  const hn::RebindToUnsigned<D> du;
  uint32_t exponents = 0;
  std::memcpy(&exponents, node.exponents, sizeof exponents);
  return hn::BitCast(d, hn::And(hn::ShiftLeft<23 - 8 * kAxis>(hn::Set(du, exponents)), hn::Set(du, 0x7F800000U)));
}

/// What the tests of boxes in steps need of a ray, in registers.
///
/// A side is origin + q step, and its parameter that times inverse plus the offset of WideRay; with the node's
/// constants S = step inverse and A = origin inverse + offset it is q S + A. In position: S has no rounding, for steps
/// are powers of two (where it underflows, by 2^-150 of a parameter, the shift is above 2^-80 and inverse above 2^-50);
/// A is off by e M. That is all that comes to what WideRay adds up, and its shift of 16 e (M + o) covers it. Without
/// fused operations the side is as float arithmetic rounds it, never inside the box: see QuantisedNode.
template <bool kFused>
struct QuantisedBoxTests {
  static constexpr uint32_t kWidth = QuantisedNode::kWidth;
  using Lanes = hn::CappedTag<float, kWidth>;
  using V = hn::Vec<Lanes>;

  V inverse_x, inverse_y, inverse_z;
  V near_x, near_y, near_z, far_x, far_y, far_z;  ///< as in BoxTests
  V t_min;
  uint32_t row_x, row_y, row_z;  ///< where a node's near sides begin; the far ones begin at that ^ kWidth

  explicit QuantisedBoxTests(const WideRay& ray)
      : inverse_x(all(ray.inverse[0])),
        inverse_y(all(ray.inverse[1])),
        inverse_z(all(ray.inverse[2])),
        near_x(all(kFused ? ray.near_offset[0] : ray.origin_near[0])),
        near_y(all(kFused ? ray.near_offset[1] : ray.origin_near[1])),
        near_z(all(kFused ? ray.near_offset[2] : ray.origin_near[2])),
        far_x(all(kFused ? ray.far_offset[0] : ray.origin_far[0])),
        far_y(all(kFused ? ray.far_offset[1] : ray.origin_far[1])),
        far_z(all(kFused ? ray.far_offset[2] : ray.origin_far[2])),
        t_min(all(ray.t_min)),
        row_x(ray.near_upper[0] * kWidth),
        row_y((2 + ray.near_upper[1]) * kWidth),
        row_z((4 + ray.near_upper[2]) * kWidth) {}

  /// Which children the ray enters within [t_min, limit], and where.
  HWY_INLINE uint32_t enter(const QuantisedNode& node, float limit, float* entry) const {
    const Lanes d;
    const uint8_t* const sides = &node.sides[0][0][0];
    const Axis x(step_of<0>(d, node), all(node.origin[0]), inverse_x, near_x, far_x);
    const Axis y(step_of<1>(d, node), all(node.origin[1]), inverse_y, near_y, far_y);
    const Axis z(step_of<2>(d, node), all(node.origin[2]), inverse_z, near_z, far_z);
    uint32_t entered = 0;
    for (uint32_t i = 0; i < kWidth; i += hn::MaxLanes(d)) {
      const auto x0 = x.near(sides + row_x + i), x1 = x.far(sides + (row_x ^ kWidth) + i);
      const auto y0 = y.near(sides + row_y + i), y1 = y.far(sides + (row_y ^ kWidth) + i);
      const auto z0 = z.near(sides + row_z + i), z1 = z.far(sides + (row_z ^ kWidth) + i);
      const auto near = hn::Max(hn::Max(x0, y0), hn::Max(z0, t_min));
      const auto far = hn::Min(hn::Min(x1, y1), hn::Min(z1, hn::Set(d, limit)));
      hn::Store(near, d, entry + i);
      entered |= bits_of(d, hn::Le(near, far)) << i;
    }
    return entered & node.places;
  }

 private:
  static HWY_INLINE V all(float value) { return hn::Set(Lanes(), value); }

  /// One axis of a node.
  struct Axis {
    V step, origin, inverse;  // fused: of the parameter's
    V near_shift, far_shift;

    HWY_INLINE Axis(V of_node, V node_origin, V ray_inverse, V ray_near, V ray_far)
        : step(kFused ? hn::Mul(of_node, ray_inverse) : of_node),
          origin(node_origin),
          inverse(ray_inverse),
          near_shift(kFused ? hn::MulAdd(node_origin, ray_inverse, ray_near) : ray_near),
          far_shift(kFused ? hn::MulAdd(node_origin, ray_inverse, ray_far) : ray_far) {}

    HWY_INLINE V near(const uint8_t* sides) const { return at(sides, near_shift); }
    HWY_INLINE V far(const uint8_t* sides) const { return at(sides, far_shift); }

   private:
    HWY_INLINE V at(const uint8_t* sides, V shift) const {
      const auto steps = steps_of(Lanes(), sides);
      if constexpr (kFused) return hn::MulAdd(steps, step, shift);
      return hn::Mul(hn::Sub(hn::Add(origin, hn::Mul(steps, step)), shift), inverse);
    }
  };
};

/// detail::may_hit_triangle() for leaves that share corners: each corner is moved and sheared once.
struct QuantisedLeafTests {
  using Lanes = hn::CappedTag<float, QuantisedLeaf::kMost>;
  static constexpr uint32_t kLanes = hn::MaxLanes(Lanes());

  float origin_x, origin_y, origin_z, shear_x, shear_y;
  uint32_t kx, ky, kz;

  explicit QuantisedLeafTests(const WideRay& ray)
      : origin_x(ray.origin[ray.kx]),
        origin_y(ray.origin[ray.ky]),
        origin_z(ray.origin[ray.kz]),
        shear_x(ray.shear[ray.kx]),
        shear_y(ray.shear[ray.ky]),
        kx(ray.kx),
        ky(ray.ky),
        kz(ray.kz) {}

  /// The triangles that the ray may hit, as bits; those left out it surely misses.
  HWY_INLINE uint32_t may_hit(const QuantisedLeaf& leaf) const {
    const hn::CappedTag<float, 16> most;
    const uint32_t all = (2U << (leaf.count() - 1)) - 1;
    if constexpr (kLanes == QuantisedLeaf::kMost) {
      if (leaf.corners <= kLanes) [[likely]]
        return some(Lanes(), OneTable<Lanes>(*this, leaf), leaf, 0) & all;
      if constexpr (hn::MaxLanes(most) == 16) {
        if (leaf.corners <= 16) return some(most, OneTable<decltype(most)>(*this, leaf), leaf, 0) & all;
      }
    }
    return many(leaf) & all;
  }

 private:
  /// Corners, moved and sheared.
  template <class D>
  struct Corners {
    using V = hn::Vec<D>;
    V x, y, z;

    HWY_INLINE Corners(const QuantisedLeafTests& ray, const QuantisedLeaf& leaf, uint32_t first)
        : z(hn::Sub(load(leaf, ray.kz, first), hn::Set(D(), ray.origin_z))) {
      x = hn::NegMulAdd(hn::Set(D(), ray.shear_x), z, hn::Sub(load(leaf, ray.kx, first), hn::Set(D(), ray.origin_x)));
      y = hn::NegMulAdd(hn::Set(D(), ray.shear_y), z, hn::Sub(load(leaf, ray.ky, first), hn::Set(D(), ray.origin_y)));
    }

   private:
    static HWY_INLINE V load(const QuantisedLeaf& leaf, uint32_t axis, uint32_t first) {
      return hn::LoadU(D(), leaf.column(axis) + first);
    }
  };

  /// All corners, as many as lanes at most.
  template <class D>
  struct OneTable : Corners<D> {
    using V = hn::Vec<D>;
    using Numbers = hn::Vec<hn::RebindToSigned<D>>;

    HWY_INLINE OneTable(const QuantisedLeafTests& ray, const QuantisedLeaf& leaf) : Corners<D>(ray, leaf, 0) {}

    HWY_INLINE void look_up(Numbers numbers, V& at_x, V& at_y, V& at_z) const {
      const auto in_table = hn::And(numbers, hn::Set(hn::RebindToSigned<D>(), int32_t{hn::MaxLanes(D()) - 1}));
      const auto places = hn::IndicesFromVec(D(), in_table);
      at_x = hn::TableLookupLanes(this->x, places);
      at_y = hn::TableLookupLanes(this->y, places);
      at_z = hn::TableLookupLanes(this->z, places);
    }
  };

  /// More of them, in memory.
  struct InMemory {
    using V = hn::Vec<Lanes>;
    using Numbers = hn::Vec<hn::RebindToSigned<Lanes>>;
    static constexpr uint32_t kRoom = 1U << QuantisedLeaf::kCornerBits;

    HWY_ALIGN float x[kRoom], y[kRoom], z[kRoom];

    HWY_INLINE InMemory(const QuantisedLeafTests& ray, const QuantisedLeaf& leaf) {
      const Lanes d;
      for (uint32_t i = 0; i < leaf.corners; i += kLanes) {
        const Corners<Lanes> corners(ray, leaf, i);
        hn::Store(corners.x, d, x + i);
        hn::Store(corners.y, d, y + i);
        hn::Store(corners.z, d, z + i);
      }
    }
    HWY_INLINE void look_up(Numbers numbers, V& at_x, V& at_y, V& at_z) const {
      const auto places = hn::And(numbers, hn::Set(hn::RebindToSigned<Lanes>(), int32_t{kRoom - 1}));
      at_x = hn::GatherIndex(Lanes(), x, places);
      at_y = hn::GatherIndex(Lanes(), y, places);
      at_z = hn::GatherIndex(Lanes(), z, places);
    }
  };

  HWY_NOINLINE uint32_t many(const QuantisedLeaf& leaf) const {
    const InMemory table(*this, leaf);
    uint32_t found = 0;
    for (uint32_t i = 0; i < leaf.count(); i += kLanes) found |= some(Lanes(), table, leaf, i) << i;
    return found;
  }

  template <class D, class Table>
  HWY_INLINE uint32_t some(D d, const Table& table, const QuantisedLeaf& leaf, uint32_t first) const {
    const hn::Rebind<uint16_t, D> d16;
    constexpr int kBits = QuantisedLeaf::kCornerBits;
    const auto words = hn::PromoteTo(
        hn::RebindToSigned<D>(), hn::LoadU(d16, reinterpret_cast<const uint16_t*>(leaf.words()) + first));
    hn::Vec<D> ax, ay, az, bx, by, bz, cx, cy, cz;
    table.look_up(words, ax, ay, az);
    table.look_up(hn::ShiftRight<kBits>(words), bx, by, bz);
    table.look_up(hn::ShiftRight<2 * kBits>(words), cx, cy, cz);
    const auto u = hn::MulSub(cx, by, hn::Mul(cy, bx));
    const auto v = hn::MulSub(ax, cy, hn::Mul(ay, cx));
    const auto w = hn::MulSub(bx, ay, hn::Mul(by, ax));
    const auto sx = hn::Max(hn::Max(hn::Abs(ax), hn::Abs(bx)), hn::Abs(cx));
    const auto sy = hn::Max(hn::Max(hn::Abs(ay), hn::Abs(by)), hn::Abs(cy));
    const auto s = hn::Max(sx, sy);
    const auto depth = hn::Max(hn::Max(hn::Abs(az), hn::Abs(bz)), hn::Abs(cz));
    // As in LeafTests.
    const auto error = hn::MulAdd(hn::Mul(s, hn::Add(s, depth)), hn::Set(d, 0x1p-19F), hn::Set(d, 0x1p-120F));
    const auto low = hn::Min(hn::Min(u, v), w), high = hn::Max(hn::Max(u, v), w);
    const auto outside = hn::And(hn::Lt(low, hn::Neg(error)), hn::Gt(high, error));
    return bits_of(d, outside) ^ ((1U << hn::MaxLanes(d)) - 1);
  }
};

/// A QuantisedNode's sides as streams take them.
struct QuantisedSides {
  template <class D>
  static HWY_INLINE hn::Vec<D> load(D d, const QuantisedNode& node, uint32_t axis, uint32_t upper, uint32_t first) {
    const auto steps = steps_of(d, node.sides[axis][upper] + first);
    return hn::Add(hn::Set(d, node.origin[axis]), hn::Mul(steps, hn::Set(d, node.step(axis))));
  }
  static HWY_INLINE uint32_t places(const QuantisedNode& node) { return node.places; }
};
