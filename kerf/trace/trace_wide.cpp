#include "kerf/trace/trace_wide.h"

#include <algorithm>
#include <bit>

#include "kerf/base/fp_environment.h"
#include "kerf/base/instruction_set.h"
#include "kerf/geometry/ray_triangle.h"
#include "kerf/trace/leaf.h"
#include "kerf/trace/stream_memory.h"
#include "kerf/trace/wide_ray.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kerf/trace/trace_wide.cpp"
#include "kerf/base/simd.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// The lanes of a mask as bits, the first lowest.
template <class D, class M>
HWY_INLINE uint32_t bits_of(D d, M mask) {
  uint8_t bits[8];
  hn::StoreMaskBits(d, mask, bits);
  return bits[0];
}

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

/// detail::may_hit_triangle() for leaves.
struct LeafTests {
  using Lanes = hn::CappedTag<float, TriangleLeaf::kMost>;
  using V = hn::Vec<Lanes>;

  V origin_x, origin_y, origin_z, shear_x, shear_y;
  uint32_t kx, ky, kz;

  explicit LeafTests(const WideRay& ray)
      : origin_x(hn::Set(Lanes(), ray.origin[ray.kx])),
        origin_y(hn::Set(Lanes(), ray.origin[ray.ky])),
        origin_z(hn::Set(Lanes(), ray.origin[ray.kz])),
        shear_x(hn::Set(Lanes(), ray.shear[ray.kx])),
        shear_y(hn::Set(Lanes(), ray.shear[ray.ky])),
        kx(ray.kx),
        ky(ray.ky),
        kz(ray.kz) {}

  /// The triangles that the ray may hit, as bits; those left out it surely misses.
  HWY_INLINE uint32_t may_hit(const TriangleLeaf& leaf) const {
    const Lanes d;
    const float* const xs = leaf.column(0, 0) + size_t{kx} * leaf.count;
    const float* const ys = leaf.column(0, 0) + size_t{ky} * leaf.count;
    const float* const zs = leaf.column(0, 0) + size_t{kz} * leaf.count;
    const size_t next = size_t{3} * leaf.count;
    if constexpr (hn::MaxLanes(d) == TriangleLeaf::kMost) {
      return some(xs, ys, zs, next) & ((1U << leaf.count) - 1);
    } else {
      uint32_t found = 0;
      for (uint32_t i = 0; i < leaf.count; i += hn::MaxLanes(d)) {
        found |= some(xs + i, ys + i, zs + i, next) << i;
      }
      return found & ((1U << leaf.count) - 1);
    }
  }

 private:
  HWY_INLINE uint32_t some(const float* xs, const float* ys, const float* zs, size_t next) const {
    const Lanes d;
    const auto az = hn::Sub(hn::LoadU(d, zs), origin_z);
    const auto bz = hn::Sub(hn::LoadU(d, zs + next), origin_z);
    const auto cz = hn::Sub(hn::LoadU(d, zs + 2 * next), origin_z);
    const auto ax = hn::NegMulAdd(shear_x, az, hn::Sub(hn::LoadU(d, xs), origin_x));
    const auto bx = hn::NegMulAdd(shear_x, bz, hn::Sub(hn::LoadU(d, xs + next), origin_x));
    const auto cx = hn::NegMulAdd(shear_x, cz, hn::Sub(hn::LoadU(d, xs + 2 * next), origin_x));
    const auto ay = hn::NegMulAdd(shear_y, az, hn::Sub(hn::LoadU(d, ys), origin_y));
    const auto by = hn::NegMulAdd(shear_y, bz, hn::Sub(hn::LoadU(d, ys + next), origin_y));
    const auto cy = hn::NegMulAdd(shear_y, cz, hn::Sub(hn::LoadU(d, ys + 2 * next), origin_y));
    const auto u = hn::MulSub(cx, by, hn::Mul(cy, bx));
    const auto v = hn::MulSub(ax, cy, hn::Mul(ay, cx));
    const auto w = hn::MulSub(bx, ay, hn::Mul(by, ax));
    const auto sx = hn::Max(hn::Max(hn::Abs(ax), hn::Abs(bx)), hn::Abs(cx));
    const auto sy = hn::Max(hn::Max(hn::Abs(ay), hn::Abs(by)), hn::Abs(cy));
    const auto s = hn::Max(sx, sy);
    const auto depth = hn::Max(hn::Max(hn::Abs(az), hn::Abs(bz)), hn::Abs(cz));
    // Where a product overflows, this does, and nothing is left out: a fused operation would take one for infinite and
    // the other as it is.
    const auto error = hn::MulAdd(hn::Mul(s, hn::Add(s, depth)), hn::Set(d, 0x1p-19F), hn::Set(d, 0x1p-120F));
    const auto low = hn::Min(hn::Min(u, v), w), high = hn::Max(hn::Max(u, v), w);
    // What is not a number counts for neither: Min and Max return one of their operands.
    const auto outside = hn::And(hn::Lt(low, hn::Neg(error)), hn::Gt(high, error));
    return bits_of(d, outside) ^ ((1U << hn::MaxLanes(d)) - 1);
  }
};

#include "kerf/trace/exact_test.h"
#include "kerf/trace/quantised_boxes.h"

/// A WideNode's sides as streams take them.
template <uint32_t kWidth>
struct WideSides {
  template <uint32_t kAxis, class D>
  static HWY_INLINE hn::Vec<D> load(D d, const WideNode<kWidth>& node, uint32_t upper, uint32_t first) {
    return hn::Load(d, node.sides[kAxis][upper] + first);
  }
  /// Others than these are entered by no ray anyway.
  static HWY_INLINE uint32_t places(const WideNode<kWidth>&) { return (1U << kWidth) - 1; }
};

/// What a Walk goes through, and how.
template <uint32_t kChildren>
struct WideTree {
  static constexpr uint32_t kWidth = kChildren;
  using Layout = WideBvh<kWidth>;
  using Node = WideNode<kWidth>;
  using Child = WideChild;
  using Leaf = TriangleLeaf;
  template <bool kFused>
  using Boxes = BoxTests<kWidth, kFused>;
  using Leaves = LeafTests;
  using Sides = WideSides<kWidth>;
};
struct QuantisedTree {
  static constexpr uint32_t kWidth = QuantisedNode::kWidth;
  using Layout = QuantisedBvh;
  using Node = QuantisedNode;
  using Child = QuantisedChild;
  using Leaf = QuantisedLeaf;
  template <bool kFused>
  using Boxes = QuantisedBoxTests<kFused>;
  using Leaves = QuantisedLeafTests;
  using Sides = QuantisedSides;
};

/// A ray on its way through such a tree.
template <class Tree, bool kFused, bool kAny, class Counts>
class Walk {
  static constexpr uint32_t kWidth = Tree::kWidth;
  using Tracer = WideTracer<typename Tree::Layout>;
  using Node = typename Tree::Node;
  using Child = typename Tree::Child;
  using Leaf = typename Tree::Leaf;

 public:
  Walk(const Tracer& tracer, const Ray& ray, const WideRay& wide, Hit& best, Counts& counts)
      : tracer_(tracer), ray_(ray), wide_(wide), best_(best), counts_(counts), boxes_(wide), leaves_(wide) {}

  HWY_INLINE void run(Child from) {
    constexpr uint32_t kMostWaiting = (kWidth - 1) * kMaxDepth;  // all children but one of each node above
    uint64_t waiting[kMostWaiting + kWidth];
    uint64_t* top = waiting;
    const Node* const nodes = tracer_.layout.nodes.data();
    uint64_t current = key(from, ray_.t_min);
    while (true) {
      counts_.count_nodes(1);
      const Child child{static_cast<uint32_t>(current)};
      if (!child.is_leaf()) {
        const Node& node = nodes[child.number()];
        HWY_ALIGN float entry[kWidth];
        counts_.count_boxes(kWidth);
        uint32_t entered = boxes_.enter(node, best_.t, entry);
        if (entered != 0) {
          current = take(node, entry, entered);
          if (entered == 0) continue;
          const uint64_t next = take(node, entry, entered);
          if constexpr (kAny) {
            // The larger child first: it stands before the others.
            for (; entered != 0; ++top) *top = take_last(node, entry, entered);
            *top++ = next;
            continue;
          }
          if (entered == 0) {
            *top++ = std::max(current, next);
            current = std::min(current, next);
            continue;
          }
          uint64_t* const base = top;
          *top++ = current;
          *top++ = next;
          do {
            *top++ = take(node, entry, entered);
          } while (entered != 0);
          sort(base, top);
          current = *--top;
          continue;
        }
      } else if (test_leaf(child)) {
        return;
      }
      do {
        if (top == waiting) return;
        current = *--top;
      } while (entry_of(current) > best_.t);
    }
  }

  /// The triangles of `found`, exactly. Whether the walk is over.
  static HWY_NOINLINE bool test_triangles(const Tracer& tracer, const Ray& ray, const WideRay& wide, Hit& best, const Leaf& triangles, uint32_t found) {
    const ExactTest exact(ray, wide);
    for (; found != 0; found &= found - 1) {
      const auto i = static_cast<uint32_t>(std::countr_zero(found));
      Crossing crossing;
      if (!exact.hits(triangles, i, wide, best.t, crossing)) continue;
      const LeafSlot slot = triangles.slot(i);
      if ((tracer.geometries[slot.geometry()].mask & ray.mask) == 0) continue;
      const Hit hit{crossing.t, crossing.u, crossing.v, slot.primitive, slot.geometry(), kNone};
      if (best && !closer(hit, best)) continue;
      best = hit;
      if (kAny) return true;
    }
    return false;
  }

 private:
  /// Nearer first as numbers, while entries are not negative; below that only the order suffers.
  static HWY_INLINE uint64_t key(Child child, float entry) {
    return uint64_t{std::bit_cast<uint32_t>(entry)} << 32 | child.word;
  }
  static HWY_INLINE float entry_of(uint64_t key) { return std::bit_cast<float>(static_cast<uint32_t>(key >> 32)); }

  static HWY_INLINE uint64_t take(const Node& node, const float* entry, uint32_t& entered) {
    const auto i = static_cast<uint32_t>(std::countr_zero(entered));
    entered &= entered - 1;
    return key(node.child[i], entry[i]);
  }

  static HWY_INLINE uint64_t take_last(const Node& node, const float* entry, uint32_t& entered) {
    const auto i = static_cast<uint32_t>(std::bit_width(entered) - 1);
    entered ^= 1U << i;
    return key(node.child[i], entry[i]);
  }

  /// The nearest last.
  static HWY_INLINE void sort(uint64_t* begin, uint64_t* end) {
    for (uint64_t* i = begin + 1; i < end; ++i) {
      const uint64_t moved = *i;
      uint64_t* j = i;
      for (; j > begin && j[-1] < moved; --j) *j = j[-1];
      *j = moved;
    }
  }

  /// Whether the walk is over: any hit is enough.
  HWY_INLINE bool test_leaf(Child leaf) {
    if (leaf.kind() == Child::kSlots) return test_slots(leaf);
    const Leaf triangles = tracer_.layout.triangles(leaf);
    if constexpr (Counts::kCounts) {
      for (const LeafSlot& slot : tracer_.layout.slots(leaf)) counts_.count_primitives(std::span(&slot, 1));
    }
    const uint32_t found = leaves_.may_hit(triangles);
    return found != 0 && test_triangles(tracer_, ray_, wide_, best_, triangles, found);
  }

  HWY_NOINLINE bool test_slots(Child leaf) {
    const PreparedRay prepared(ray_);
    for (const LeafSlot& slot : tracer_.layout.slots(leaf)) {
      if (test_primitive(tracer_.geometries, slot, prepared, best_, counts_) && kAny) return true;
    }
    return false;
  }

  const Tracer& tracer_;
  const Ray& ray_;
  const WideRay& wide_;
  Hit& best_;
  Counts& counts_;
  const typename Tree::template Boxes<kFused> boxes_;
  const typename Tree::Leaves leaves_;
};

#include "kerf/trace/wide_stream.h"

template <class Tree>
struct Kernel {
  using Tracer = WideTracer<typename Tree::Layout>;

  const Tracer& tracer;

  static Kernel at(const void* data) { return {*static_cast<const Tracer*>(data)}; }

  template <bool kAny, class Counts>
  Hit trace(const Ray& ray, Counts& counts) const {
    const StandardFloat standard;
    if (tracer.layout.is_empty()) return {};
    const Box3f& bounds = tracer.layout.bounds;
    const Float4 lower{bounds.lower.x, bounds.lower.y, bounds.lower.z, 0};
    const Float4 upper{bounds.upper.x, bounds.upper.y, bounds.upper.z, 0};
    const WideRay wide(ray, lower, upper);
    if (!wide.valid) return {};
    Hit best;
    best.t = wide.t_max;
    counts.count_boxes(1);
    if (!wide.enters(lower, upper)) return {};
    if (wide.is_fused) {
      Walk<Tree, true, kAny, Counts>(tracer, ray, wide, best, counts).run(tracer.layout.root);
    } else {
      Walk<Tree, false, kAny, Counts>(tracer, ray, wide, best, counts).run(tracer.layout.root);
    }
    return finished(best);
  }

  /// Counts are those of single rays.
  template <class Result, class Counts>
  void trace_batch(std::span<const Ray> rays, std::span<Result> results, Counts& counts) const {
    const auto single = [&](const Ray& ray) { return trace<!std::is_same_v<Result, Hit>>(ray, counts); };
    if (!Counts::kCounts && trace_streams<Tree>(tracer, rays, results, single)) return;
    for (size_t i = 0; i < rays.size(); ++i) results[i] = result_of<Result>(single(rays[i]));
  }
};

const TraceTable* table4() { return &kTraceTable<Kernel<WideTree<4>>>; }
const TraceTable* table8() { return &kTraceTable<Kernel<WideTree<8>>>; }
const TraceTable* quantised_table() { return &kTraceTable<Kernel<QuantisedTree>>; }

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kerf {

HWY_EXPORT(table4);
HWY_EXPORT(table8);
HWY_EXPORT(quantised_table);

template <>
WideKernels wide_kernels<WideBvh<4>>() {
  const InstructionSet set = chosen_instruction_set();
  return {KERF_DISPATCH(table4, set)(), set.name};
}
template <>
WideKernels wide_kernels<WideBvh<8>>() {
  const InstructionSet set = chosen_instruction_set();
  return {KERF_DISPATCH(table8, set)(), set.name};
}
template <>
WideKernels wide_kernels<QuantisedBvh>() {
  const InstructionSet set = chosen_instruction_set();
  return {KERF_DISPATCH(quantised_table, set)(), set.name};
}

}  // namespace kerf
#endif
