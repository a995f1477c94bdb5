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

  template <class Leaf>
  HWY_INLINE bool hits(const Leaf& leaf, uint32_t i, const WideRay& ray, float limit, Crossing& crossing) const {
    Corners x, y, z;
    load(leaf, ray.axes.kx, i, x);
    load(leaf, ray.axes.ky, i, y);
    load(leaf, ray.axes.kz, i, z);
    z -= origin_z_;
    x = x - origin_x_ - shear_x_ * z;
    y = y - origin_y_ - shear_y_ * z;
    const Corners x_cab = __builtin_shufflevector(x, x, 2, 0, 1, 3), y_cab = __builtin_shufflevector(y, y, 2, 0, 1, 3);
    const Corners x_bca = __builtin_shufflevector(x, x, 1, 2, 0, 3), y_bca = __builtin_shufflevector(y, y, 1, 2, 0, 3);
    const Corners edges = x_cab * y_bca - y_cab * x_bca;
    const double u = edges[0], v = edges[1], w = edges[2];
    if (std::min(std::min(u, v), w) < 0 && std::max(std::max(u, v), w) > 0) return false;
    const double area = u + v + w;
    if (area == 0) return false;
    const Corners depths = edges * z;
    const double t = (depths[0] + depths[1] + depths[2]) / (area * z_);
    crossing.t = without_minus_zero(static_cast<float>(t));
    if (!(crossing.t >= ray.t_min && crossing.t <= limit && std::isfinite(crossing.t))) return false;
    crossing.u = without_minus_zero(static_cast<float>(v / area));
    crossing.v = without_minus_zero(static_cast<float>(w / area));
    return true;
  }

 private:
  using Corners [[gnu::vector_size(32)]] = double;

  static HWY_INLINE void load(const TriangleLeaf& leaf, uint32_t axis, uint32_t i, Corners& to) {
    const float* const first = leaf.column(0, axis) + i;
    const size_t next = size_t{3} * leaf.count;
    to = Corners{first[0], first[next], first[2 * next], 0};
  }
  static HWY_INLINE void load(const QuantisedLeaf& leaf, uint32_t axis, uint32_t i, Corners& to) {
    const float* const column = leaf.column(axis);
    const uint32_t word = leaf.word(i);
    to = Corners{column[QuantisedLeaf::corner_number(word, 0)], column[QuantisedLeaf::corner_number(word, 1)],
                 column[QuantisedLeaf::corner_number(word, 2)], 0};
  }

  double z_, shear_x_, shear_y_, origin_x_, origin_y_, origin_z_;
};
