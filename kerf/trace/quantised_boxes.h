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
/// node's constants S = size inverse and A = base inverse + offset it is f S + A. In position, C and o as there: a size
/// is at most 4 C along x, where f is at most 1.5, and 2 C along y and z; so S is off by 6 e C, A, which lies as far
/// before the boxes as their size is, by e (5 C + o), the sum by e (C + o); inverse, the offset and a hit's t by
/// e (2 C + 4 o) as there. That is e (14 C + 6 o), and its shift of 16 e (C + 2 o) covers it; where S underflows, by
/// 2^-150 of a parameter, the shift is above 2^-80 and inverse above 2^-50. Without fused operations the side is as
/// float arithmetic rounds it, never inside the box: see QuantisedNode.
template <bool kFused>
struct QuantisedBoxTests {
  static constexpr uint32_t kWidth = QuantisedNode::kWidth;
  using Lanes = hn::CappedTag<float, kWidth>;
  using V = hn::Vec<Lanes>;

  V inverse_x, inverse_y, inverse_z;
  V near_x, near_y, near_z, far_x, far_y, far_z;  ///< as in BoxTests
  V t_min;
  const SideRows& rows;

  explicit QuantisedBoxTests(const WideRay& ray)
      : inverse_x(all(ray.inverse[0])),
        inverse_y(all(ray.inverse[1])),
        inverse_z(all(ray.inverse[2])),
        near_x(all((kFused ? ray.near_offset() : ray.origin_near_moved())[0])),
        near_y(all((kFused ? ray.near_offset() : ray.origin_near_moved())[1])),
        near_z(all((kFused ? ray.near_offset() : ray.origin_near_moved())[2])),
        far_x(all((kFused ? ray.far_offset() : ray.origin_far_moved())[0])),
        far_y(all((kFused ? ray.far_offset() : ray.origin_far_moved())[1])),
        far_z(all((kFused ? ray.far_offset() : ray.origin_far_moved())[2])),
        t_min(all(ray.t_min)),
        rows(kSideRows<kWidth, 0>.by_octant[ray.octant]) {}

  /// As of BoxTests.
  HWY_INLINE uint32_t enter(const QuantisedNode& node, float limit, float* entry) const {
    uint32_t entered = 0;
    test(node, limit, [&](uint32_t i, V near, uint32_t some) {
      hn::Store(near, Lanes(), entry + i);
      entered |= some << i;
    });
    return entered & places(node);
  }
  /// The key of the child to go on with, ChildKey::kNone if none is entered; the others' are put on top.
  template <bool kAny>
  HWY_INLINE uint64_t take(const QuantisedNode& node, float limit, uint64_t*& top) const {
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3
    uint64_t taken = 0;
    test(node, limit, [&](uint32_t, V near, uint32_t some) {
      const VectorKeys<kWidth> keys(&node.child[0].word, near, some & places(node));
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
  static HWY_INLINE uint32_t places(const QuantisedNode& node) { return (1U << node.children) - 1; }

  /// As of BoxTests.
  template <class F>
  HWY_INLINE void test(const QuantisedNode& node, float limit, F&& f) const {
    const Lanes d;
    const uint32_t* const sides = &node.sides[0][0];
    const Axis<0> x(node, inverse_x, near_x, far_x);
    const Axis<1> y(node, inverse_y, near_y, far_y);
    const Axis<2> z(node, inverse_z, near_z, far_z);
    for (uint32_t i = 0; i < kWidth; i += hn::MaxLanes(d)) {
      const auto x0 = x.near(sides + rows.near[0] + i), x1 = x.far(sides + rows.far[0] + i);
      const auto y0 = y.near(sides + rows.near[1] + i), y1 = y.far(sides + rows.far[1] + i);
      const auto z0 = z.near(sides + rows.near[2] + i), z1 = z.far(sides + rows.far[2] + i);
      V near;
      const uint32_t entered = overlap<kFused>(d, {x0, y0, z0, t_min}, {x1, y1, z1, hn::Set(d, limit)}, near);
      f(i, near, entered);
    }
  }

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
    return SeenFrom{ray}.corners(d, leaf.column(ray.axes.kx) + first, leaf.column(ray.axes.ky) + first,
                                 leaf.column(ray.axes.kz) + first);
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
  template <uint32_t kAxis, class D>
  static HWY_INLINE hn::Vec<D> load(D d, const QuantisedNode& node, uint32_t upper, uint32_t first) {
    const auto ends = ends_of<kAxis>(d, node.sides[upper] + first);
    return hn::MulAdd(ends, hn::Set(d, node.size[kAxis]), hn::Set(d, node.base[kAxis]));
  }
  static HWY_INLINE uint32_t places(const QuantisedNode& node) { return (1U << node.children) - 1; }
};
