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

/// The tests of a QuantisedLeaf: each corner is moved and sheared once.
struct QuantisedLeafTests {
  using Lanes = hn::CappedTag<float, QuantisedLeaf::kMost>;
  static constexpr uint32_t kLanes = hn::MaxLanes(Lanes());

  const WideRay& ray;

  /// As of LeafTests.
  HWY_INLINE uint32_t may_hit(const QuantisedLeaf& leaf) const { return look<false>(leaf, 0, nullptr).maybe; }
  HWY_INLINE Found find(const QuantisedLeaf& leaf, float limit, Between& between) const {
    return look<true>(leaf, limit, &between);
  }

 private:
  template <class D>
  using Numbers = hn::Vec<hn::RebindToSigned<D>>;

  template <bool kPlaced>
  HWY_INLINE Found look(const QuantisedLeaf& leaf, float limit, Between* between) const {
    const hn::CappedTag<float, 16> most;
    if constexpr (kLanes == QuantisedLeaf::kMost) {
      if (leaf.corners <= kLanes) [[likely]]
        return some<kPlaced>(Lanes(), OneTable<Lanes>(ray, leaf), leaf, 0, limit, between);
      if constexpr (hn::MaxLanes(most) == 16) {
        if (leaf.corners <= 16)
          return some<kPlaced>(most, OneTable<hn::CappedTag<float, 16>>(ray, leaf), leaf, 0, limit, between);
      }
    }
    return many<kPlaced>(leaf, limit, between);
  }

  template <class D>
  static HWY_INLINE SeenCorners<D> corners(D d, const WideRay& ray, const QuantisedLeaf& leaf, uint32_t first) {
    return SeenFrom{ray}.corners(d, leaf.column(ray.kx) + first, leaf.column(ray.ky) + first,
                                 leaf.column(ray.kz) + first);
  }

  /// All corners, as many as lanes at most.
  template <class D>
  struct OneTable {
    SeenCorners<D> all;

    HWY_INLINE OneTable(const WideRay& ray, const QuantisedLeaf& leaf) : all(corners(D(), ray, leaf, 0)) {}

    HWY_INLINE SeenCorners<D> look_up(Numbers<D> numbers) const {
      const auto in_table = hn::And(numbers, hn::Set(hn::RebindToSigned<D>(), int32_t{hn::MaxLanes(D()) - 1}));
      const auto places = hn::IndicesFromVec(D(), in_table);
      return {hn::TableLookupLanes(all.x, places), hn::TableLookupLanes(all.y, places),
              hn::TableLookupLanes(all.z, places)};
    }
  };

  /// More of them, in memory.
  struct InMemory {
    static constexpr uint32_t kRoom = 1U << QuantisedLeaf::kCornerBits;

    HWY_ALIGN float x[kRoom], y[kRoom], z[kRoom];

    HWY_INLINE InMemory(const WideRay& ray, const QuantisedLeaf& leaf) {
      const Lanes d;
      for (uint32_t i = 0; i < leaf.corners; i += kLanes) {
        const SeenCorners<Lanes> some = corners(d, ray, leaf, i);
        hn::Store(some.x, d, x + i);
        hn::Store(some.y, d, y + i);
        hn::Store(some.z, d, z + i);
      }
    }
    HWY_INLINE SeenCorners<Lanes> look_up(Numbers<Lanes> numbers) const {
      const auto places = hn::And(numbers, hn::Set(hn::RebindToSigned<Lanes>(), int32_t{kRoom - 1}));
      const Lanes d;
      return {hn::GatherIndex(d, x, places), hn::GatherIndex(d, y, places), hn::GatherIndex(d, z, places)};
    }
  };

  template <bool kPlaced>
  HWY_NOINLINE Found many(const QuantisedLeaf& leaf, float limit, Between* between) const {
    const InMemory table(ray, leaf);
    Found found;
    for (uint32_t i = 0; i < leaf.count(); i += kLanes) {
      const Found more = some<kPlaced>(Lanes(), table, leaf, i, limit, between);
      found.maybe |= more.maybe << i;
      found.sure |= more.sure << i;
    }
    return found;
  }

  template <bool kPlaced, class D, class Table>
  HWY_INLINE Found some(D /*d*/, const Table& table, const QuantisedLeaf& leaf, uint32_t first, float limit,
                        Between* between) const {
    const hn::Rebind<uint16_t, D> d16;
    constexpr int kBits = QuantisedLeaf::kCornerBits;
    const auto words =
        hn::PromoteTo(hn::RebindToSigned<D>(), hn::LoadU(d16, reinterpret_cast<const uint16_t*>(leaf.words()) + first));
    const SeenTriangles<D> seen(table.look_up(words), table.look_up(hn::ShiftRight<kBits>(words)),
                                table.look_up(hn::ShiftRight<2 * kBits>(words)));
    const uint32_t maybe = seen.may_hit() & (((2U << (leaf.count() - 1)) - 1) >> first);
    if (!kPlaced || maybe == 0) return {maybe, 0};
    return seen.find(ray, maybe, limit, between->least + first, between->most + first);
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
