// No include guard on purpose: a part of trace_wide.cpp, which includes it once for each instruction set, in
// HWY_NAMESPACE.

/// Corners of triangles, a vector of them, as the ray sees them: it runs along z through x = y = 0. Point mirrored,
/// which saves operations and changes no edge function.
template <class D>
struct SeenCorners {
  hn::Vec<D> x, y, z;
};

/// What the triangle tests need of a ray.
struct SeenFrom {
  const WideRay& ray;

  template <class D>
  HWY_INLINE SeenCorners<D> corners(D d, const float* xs, const float* ys, const float* zs) const {
    const auto z = hn::Sub(hn::Set(d, ray.origin[ray.axes.kz]), hn::LoadU(d, zs));
    const auto x = hn::Sub(hn::Set(d, ray.origin[ray.axes.kx]), hn::LoadU(d, xs));
    const auto y = hn::Sub(hn::Set(d, ray.origin[ray.axes.ky]), hn::LoadU(d, ys));
    return {hn::NegMulAdd(hn::Set(d, ray.shear[ray.axes.kx]), z, x),
            hn::NegMulAdd(hn::Set(d, ray.shear[ray.axes.ky]), z, y), z};
  }
};

/// Triangles of a leaf, as bits.
struct Found {
  uint32_t maybe = 0;  ///< that the ray may hit within [t_min, limit]; the others it surely does not
  uint32_t sure = 0;   ///< of these, those that it surely hits, if not beyond the limit
};

/// Between which t rays surely hit the triangles of a leaf; room for a vector more, which has no meaning.
struct Between {
  float least[2 * TriangleLeaf::kMost];
  float most[2 * TriangleLeaf::kMost];
};

#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3
constexpr int kMaxOfSizes = 0b1011;  // of vrangeps: the larger size, without its sign
HWY_INLINE __m128 larger_size(__m128 a, __m128 b) { return _mm_range_ps(a, b, kMaxOfSizes); }
HWY_INLINE __m256 larger_size(__m256 a, __m256 b) { return _mm256_range_ps(a, b, kMaxOfSizes); }
HWY_INLINE __m512 larger_size(__m512 a, __m512 b) { return _mm512_range_ps(a, b, kMaxOfSizes); }
template <class V>
HWY_INLINE V largest_size(V a, V b, V c) {
  return V{larger_size(larger_size(a.raw, b.raw), c.raw)};
}
#else
template <class V>
HWY_INLINE V largest_size(V a, V b, V c) {
  return hn::Max(hn::Max(hn::Abs(a), hn::Abs(b)), hn::Abs(c));
}
#endif

/// A vector of triangles and the ray's tests of them, in float with bounds on the errors.
template <class D>
class SeenTriangles {
 public:
  using V = hn::Vec<D>;

  /// For the bound on the error of edge functions see detail::may_hit_triangle().
  HWY_INLINE SeenTriangles(const SeenCorners<D>& a, const SeenCorners<D>& b, const SeenCorners<D>& c)
      : az_(a.z), bz_(b.z), cz_(c.z) {
    const D d;
    u_ = hn::MulSub(c.x, b.y, hn::Mul(c.y, b.x));
    v_ = hn::MulSub(a.x, c.y, hn::Mul(a.y, c.x));
    w_ = hn::MulSub(b.x, a.y, hn::Mul(b.y, a.x));
    const auto s = hn::Max(largest_size(a.x, b.x, c.x), largest_size(a.y, b.y, c.y));
    depth_ = largest_size(az_, bz_, cz_);
    // Where a product overflows, this does, and nothing is left out: a fused operation would take one for infinite and
    // the other as it is. The constant is for underflow, and for find().
    error_ = hn::MulAdd(hn::Mul(s, hn::Add(s, depth_)), hn::Set(d, 0x1p-19F), hn::Set(d, 0x1p-60F));
    low_ = hn::Min(hn::Min(u_, v_), w_);
    high_ = hn::Max(hn::Max(u_, v_), w_);
  }

  /// Those that the ray may hit at any t, as bits; those left out it surely misses.
  HWY_INLINE uint32_t may_hit() const {
    // What is not a number counts for neither: Min and Max return one of their operands.
    const auto outside = hn::Gt(hn::Min(hn::Neg(low_), high_), error_);
    return bits_of(D(), outside) ^ kAll;
  }

  /// Where the ray, a usual one, surely hits those of which that can be told.
  ///
  /// With E the bound on the edge functions' error, A their sum and Z the largest depth: the weights of the corners,
  /// edge functions over A, are off by 6 E / A together, so the depth, a mean between the corners' depths, by 3 E / A
  /// of what lies between these; the roundings of depths, products, sums, quotient and t by 12 e Z, e = 2^-24. Bounds
  /// used: 4 E / A, 2^-19 Z, and 2^-80 for underflow, while A is at least 3 E, which is 2^-60 at least. With corners
  /// within 2^38 and the direction from 2^-40 to 2^38 only the bounds can overflow, and what is infinite is not sure.
  HWY_INLINE Found find(const WideRay& ray, uint32_t maybe, float limit, float* least, float* most) const {
    const D d;
    const auto inverse_z = hn::Set(d, -ray.inverse[ray.axes.kz]);  // corners are mirrored
    const auto inside = hn::Gt(hn::Max(low_, hn::Neg(high_)), error_);
    const auto inverse = hn::Div(hn::Set(d, 1), hn::Add(hn::Add(u_, v_), w_));
    const auto z = hn::Mul(hn::MulAdd(u_, az_, hn::MulAdd(v_, bz_, hn::Mul(w_, cz_))), inverse);
    const auto between = hn::Sub(hn::Max(hn::Max(az_, bz_), cz_), hn::Min(hn::Min(az_, bz_), cz_));
    const auto weights = hn::Mul(hn::Mul(error_, hn::Set(d, 4)), hn::Abs(inverse));
    const auto off = hn::MulAdd(weights, between, hn::MulAdd(depth_, hn::Set(d, 0x1p-19F), hn::Set(d, 0x1p-80F)));
    const auto t = hn::Mul(z, inverse_z), t_off = hn::Mul(off, hn::Abs(inverse_z));
    const auto from = hn::Sub(t, t_off), to = hn::Add(t, t_off);
    const auto t_min = hn::Set(d, ray.t_min);
    const auto beyond = hn::Or(hn::Gt(from, hn::Set(d, limit)), hn::Lt(to, t_min));
    hn::StoreU(from, d, least);
    hn::StoreU(to, d, most);
    const uint32_t left = maybe & ~bits_of(d, hn::And(inside, beyond));
    return {left, left & bits_of(d, hn::And(inside, hn::Ge(from, t_min)))};
  }

 private:
  static constexpr uint32_t kAll = (1U << hn::MaxLanes(D())) - 1;

  V u_, v_, w_, az_, bz_, cz_;
  V depth_, error_, low_, high_;
};

/// The tests of a TriangleLeaf.
struct LeafTests {
  using Lanes = hn::CappedTag<float, TriangleLeaf::kMost>;
  static constexpr uint32_t kLanes = hn::MaxLanes(Lanes());

  const WideRay& ray;

  /// The triangles that the ray may hit at any t, as bits; those left out it surely misses.
  HWY_INLINE uint32_t may_hit(const TriangleLeaf& leaf) const {
    uint32_t maybe = 0;
    for (uint32_t i = 0; i < count(leaf); i += kLanes) maybe |= see(leaf, i).may_hit() << i;
    return maybe & ((1U << leaf.count) - 1);
  }

  HWY_INLINE Found find(const TriangleLeaf& leaf, float limit, Between& between) const {
    Found found;
    for (uint32_t i = 0; i < count(leaf); i += kLanes) {
      const SeenTriangles<Lanes> seen = see(leaf, i);
      const uint32_t maybe = seen.may_hit() & (((1U << leaf.count) - 1) >> i);
      if (maybe == 0) continue;
      const Found some = seen.find(ray, maybe, limit, between.least + i, between.most + i);
      found.maybe |= some.maybe << i;
      found.sure |= some.sure << i;
    }
    return found;
  }

 private:
  /// Known to the compiler where one vector is enough.
  static HWY_INLINE uint32_t count(const TriangleLeaf& leaf) { return kLanes == TriangleLeaf::kMost ? 1 : leaf.count; }

  HWY_INLINE SeenTriangles<Lanes> see(const TriangleLeaf& leaf, uint32_t first) const {
    const float* const xs = leaf.column(0, 0) + size_t{ray.axes.kx} * leaf.count + first;
    const float* const ys = leaf.column(0, 0) + size_t{ray.axes.ky} * leaf.count + first;
    const float* const zs = leaf.column(0, 0) + size_t{ray.axes.kz} * leaf.count + first;
    const size_t next = size_t{3} * leaf.count;
    const SeenFrom from{ray};
    const Lanes d;
    return {from.corners(d, xs, ys, zs), from.corners(d, xs + next, ys + next, zs + next),
            from.corners(d, xs + 2 * next, ys + 2 * next, zs + 2 * next)};
  }
};
