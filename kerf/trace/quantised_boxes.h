// No include guard on purpose: a part of trace_wide.cpp, which includes it once for each instruction set, in
// HWY_NAMESPACE, after BoxTests and LeafTests.

/// Where boxes end along x, y or z, from their words: how many times a node's size from its base.
template <uint32_t kAxis, class D>
HWY_INLINE hn::Vec<D> ends_of(D d, const uint32_t* words) {
  const hn::RebindToUnsigned<D> du;
  constexpr int kShift =
      static_cast<int>(QuantisedNode::kMantissaPlaces[kAxis]) - static_cast<int>(QuantisedNode::kPlaces[kAxis]);
  constexpr uint32_t kMask = QuantisedNode::kMostSteps << QuantisedNode::kMantissaPlaces[kAxis];
  auto bits = hn::Load(du, words);
  if constexpr (kShift > 0) bits = hn::ShiftLeft<kShift>(bits);
  if constexpr (kShift < 0) bits = hn::ShiftRight<-kShift>(bits);
  return hn::BitCast(d, hn::OrAnd(hn::Set(du, QuantisedNode::kOne), bits, hn::Set(du, kMask)));
}

/// What the tests of boxes in steps need of a ray, in registers.
///
/// A side is base + f size, f from 1 to 2, and its parameter that times inverse plus the offset of WideRay; with the
/// node's constants S = size inverse and A = base inverse + offset it is f S + A. In position: sizes are 4 M at most
/// along x, where f is at most 1.5, and 2 M along y and z; so S is off by 6 e M at most, A, which lies as far before the
/// box as it is large, by 5 e M, the sum by e M. With what WideRay adds up but the rounding of its sum that is
/// e (14 M + 2 o), which its shift of 16 e (M + o) covers; where S underflows, by 2^-150 of a parameter, the shift is
/// above 2^-80 and inverse above 2^-50. Without fused operations the side is as float arithmetic rounds it, never inside
/// the box: see QuantisedNode.
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
        row_y(ray.near_upper[1] * kWidth),
        row_z(ray.near_upper[2] * kWidth) {}

  /// Which children the ray enters within [t_min, limit], and where.
  HWY_INLINE uint32_t enter(const QuantisedNode& node, float limit, float* entry) const {
    const Lanes d;
    const uint32_t* const sides = &node.sides[0][0];
    const Axis<0> x(node, inverse_x, near_x, far_x);
    const Axis<1> y(node, inverse_y, near_y, far_y);
    const Axis<2> z(node, inverse_z, near_z, far_z);
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
    return entered & ((1U << node.children) - 1);
  }

 private:
  static HWY_INLINE V all(float value) { return hn::Set(Lanes(), value); }

  /// One axis of a node.
  template <uint32_t kAxis>
  struct Axis {
    V size, base, inverse;  // size fused: of the parameter's
    V near_shift, far_shift;

    HWY_INLINE Axis(const QuantisedNode& node, V ray_inverse, V ray_near, V ray_far)
        : size(all(node.size[kAxis])), base(all(node.base[kAxis])), inverse(ray_inverse) {
      if constexpr (kFused) size = hn::Mul(size, inverse);
      near_shift = kFused ? hn::MulAdd(base, inverse, ray_near) : ray_near;
      far_shift = kFused ? hn::MulAdd(base, inverse, ray_far) : ray_far;
    }

    HWY_INLINE V near(const uint32_t* sides) const { return at(sides, near_shift); }
    HWY_INLINE V far(const uint32_t* sides) const { return at(sides, far_shift); }

   private:
    HWY_INLINE V at(const uint32_t* sides, V shift) const {
      const auto ends = ends_of<kAxis>(Lanes(), sides);
      if constexpr (kFused) return hn::MulAdd(ends, size, shift);
      return hn::Mul(hn::Sub(hn::MulAdd(ends, size, base), shift), inverse);
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
  template <uint32_t kAxis, class D>
  static HWY_INLINE hn::Vec<D> load(D d, const QuantisedNode& node, uint32_t upper, uint32_t first) {
    const auto ends = ends_of<kAxis>(d, node.sides[upper] + first);
    return hn::MulAdd(ends, hn::Set(d, node.size[kAxis]), hn::Set(d, node.base[kAxis]));
  }
  static HWY_INLINE uint32_t places(const QuantisedNode& node) { return (1U << node.children) - 1; }
};
