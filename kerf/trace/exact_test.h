// No include guard on purpose: a part of trace_wide.cpp, which includes it once for each instruction set, in
// HWY_NAMESPACE.

/// intersect() of triangles that a ray may hit, the three corners side by side; the same operations, so the same bits.
/// Four doubles as a language extension, which every target has in some form.
class ExactTest {
 public:
  explicit ExactTest(const Ray& ray, const WideRay& wide)
      : z_(static_cast<double>(ray.direction[wide.axes.kz] + 0.0F)),
        shear_x_(static_cast<double>(ray.direction[wide.axes.kx] + 0.0F) / z_),
        shear_y_(static_cast<double>(ray.direction[wide.axes.ky] + 0.0F) / z_) {
    origin_x_ = wide.origin[wide.axes.kx];
    origin_y_ = wide.origin[wide.axes.ky];
    origin_z_ = wide.origin[wide.axes.kz];
  }

  /// Whether it is hit at most at limit, and where.
  template <class Leaf>
  HWY_INLINE bool hits(const Leaf& leaf, uint32_t i, const WideRay& ray, float limit, Crossing& crossing) const {
    Seen seen;
    see(leaf, i, ray, seen);
    const double u = seen.edges[0], v = seen.edges[1], w = seen.edges[2];
    if (std::min(std::min(u, v), w) < 0 && std::max(std::max(u, v), w) > 0) return false;
    if (u + v + w == 0) return false;
    crossing = crossing_of(seen);
    return crossing.t >= ray.t_min && crossing.t <= limit && std::isfinite(crossing.t);
  }

  /// Of one that is known to be hit.
  template <class Leaf>
  HWY_INLINE Crossing crossing(const Leaf& leaf, uint32_t i, const WideRay& ray) const {
    Seen seen;
    see(leaf, i, ray, seen);
    return crossing_of(seen);
  }

 private:
  using Corners [[gnu::vector_size(32)]] = double;

  /// A triangle as the ray sees it.
  struct Seen {
    Corners edges;  // u, v and w
    Corners z;
  };

  template <class Leaf>
  HWY_INLINE void see(const Leaf& leaf, uint32_t i, const WideRay& ray, Seen& seen) const {
    Corners x, y, z;
    load(leaf, ray.axes.kx, i, x);
    load(leaf, ray.axes.ky, i, y);
    load(leaf, ray.axes.kz, i, z);
    z -= origin_z_;
    x = x - origin_x_ - shear_x_ * z;
    y = y - origin_y_ - shear_y_ * z;
    const Corners x_cab = __builtin_shufflevector(x, x, 2, 0, 1, 3), y_cab = __builtin_shufflevector(y, y, 2, 0, 1, 3);
    const Corners x_bca = __builtin_shufflevector(x, x, 1, 2, 0, 3), y_bca = __builtin_shufflevector(y, y, 1, 2, 0, 3);
    seen.edges = x_cab * y_bca - y_cab * x_bca;
    seen.z = z;
  }

  HWY_INLINE Crossing crossing_of(const Seen& seen) const {
    const double v = seen.edges[1], w = seen.edges[2], area = seen.edges[0] + v + w;
    const Corners depths = seen.edges * seen.z;
    const Corners shares = Corners{depths[0] + depths[1] + depths[2], v, w, 0} / Corners{area * z_, area, area, 1};
    return {without_minus_zero(static_cast<float>(shares[0])), without_minus_zero(static_cast<float>(shares[1])),
            without_minus_zero(static_cast<float>(shares[2]))};
  }

  static HWY_INLINE void load(const TriangleLeaf& leaf, uint32_t axis, uint32_t i, Corners& to) {
    const float* const first = leaf.column(0, axis) + i;
    const size_t next = size_t{3} * leaf.count;
    convert(Float4{first[0], first[next], first[2 * next], 0}, to);
  }
  static HWY_INLINE void load(const QuantisedLeaf& leaf, uint32_t axis, uint32_t i, Corners& to) {
    const float* const column = leaf.column(axis);
    const uint32_t word = leaf.word(i);
    convert(Float4{column[QuantisedLeaf::corner_number(word, 0)], column[QuantisedLeaf::corner_number(word, 1)],
                   column[QuantisedLeaf::corner_number(word, 2)], 0},
            to);
  }
  static HWY_INLINE void convert(Float4 a, Corners& to) {
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2
    to = _mm256_cvtps_pd(a);  // for which compilers take four steps
#else
    to = __builtin_convertvector(a, Corners);
#endif
  }

  double z_, shear_x_, shear_y_, origin_x_, origin_y_, origin_z_;
};
