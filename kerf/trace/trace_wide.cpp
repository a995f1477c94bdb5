#include "kerf/trace/trace_wide.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <memory>
#include <new>
#include <utility>

#include "kerf/base/fp_environment.h"
#include "kerf/base/instruction_set.h"
#include "kerf/geometry/ray_triangle.h"
#include "kerf/trace/leaf.h"
#include "kerf/trace/nearest_hit.h"
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

#include "kerf/trace/child_keys.h"
#include "kerf/trace/exact_test.h"
#include "kerf/trace/leaf_tests.h"
#include "kerf/trace/quantised_boxes.h"
#include "kerf/trace/wide_boxes.h"

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
  template <bool kUsual>
  using Boxes = BoxTests<kWidth, kUsual>;
  using Leaves = LeafTests;
  using Sides = WideSides<kWidth>;
};
struct QuantisedTree {
  static constexpr uint32_t kWidth = QuantisedNode::kWidth;
  using Layout = QuantisedBvh;
  using Node = QuantisedNode;
  using Child = QuantisedChild;
  using Leaf = QuantisedLeaf;
  template <bool kUsual>
  using Boxes = QuantisedBoxTests<kUsual>;
  using Leaves = QuantisedLeafTests;
  using Sides = QuantisedSides;
};

#include "kerf/trace/leaf_visits.h"

/// A ray on its way through such a tree.
template <class Tree, bool kUsual, bool kAny, class Counts>
class Walk {
  static constexpr uint32_t kWidth = Tree::kWidth;
  using Tracer = WideTracer<typename Tree::Layout>;
  using Node = typename Tree::Node;
  using Child = typename Tree::Child;
  using Visits = LeafVisits<Tree, kAny, Counts>;

 public:
  Walk(const Tracer& tracer, const Ray& ray, const WideRay& wide, NearestHit& nearest, Counts& counts)
      : visits_(tracer, ray, wide, nearest, counts),
        tracer_(tracer),
        ray_(ray),
        wide_(wide),
        nearest_(nearest),
        counts_(counts) {}

  /// The loop over inner nodes calls nothing, so that what it needs stays in registers.
  HWY_INLINE void run(Child from) {
    constexpr uint32_t kMostWaiting = (kWidth - 1) * kMaxDepth;  // all children but one of each node above
    uint64_t waiting[1 + kMostWaiting + kWidth];
    uint64_t* top = waiting;
    *top++ = ChildKey::end<Child>();
    const Node* const nodes = tracer_.layout.nodes.data();
    const typename Tree::template Boxes<kUsual> boxes(wide_);
    uint64_t current = ChildKey::of(from.word, ray_.t_min);
    float limit = nearest_.hit.t;
    while (true) {
      while (!child_of(current).is_leaf()) {
        counts_.count_nodes(1);
        counts_.count_boxes(kWidth);
        const Node& node = nodes[child_of(current).number()];
        HWY_ALIGN float entry[kWidth];
        const uint32_t entered = boxes.enter(node, limit, entry);
        if (entered == 0) {
          current = next(top, limit);
        } else {
          current = kAny ? largest_of(node, entry, entered, top) : nearest_of(node, entry, entered, top);
        }
      }
      const Child leaf = child_of(current);
      if (leaf.kind() == Child::kEnd) return;
      counts_.count_nodes(1);
      if (visits_.test(leaf)) return;
      limit = nearest_.hit.t;
      current = next(top, limit);
    }
  }

 private:
  static HWY_INLINE Child child_of(uint64_t key) { return {ChildKey::word(key)}; }

  /// The one on top that is not beyond the limit. The one at the bottom is not.
  static HWY_INLINE uint64_t next(uint64_t*& top, float limit) {
    do {
      --top;
    } while (ChildKey::entry(*top) > limit);
    return *top;
  }

  /// Puts all children that are entered on top but the one to go on with, which it returns: the nearest, and below it
  /// the others in order. What is compared decides no branch: it would be mispredicted every other time.
  static HWY_INLINE uint64_t nearest_of(const Node& node, const float* entry, uint32_t entered, uint64_t*& top) {
    uint64_t a = take(node, entry, entered);
    if (entered == 0) return a;
    uint64_t b = take(node, entry, entered);
    ChildKey::order(b, a);
    if (entered == 0) {
      *top++ = b;
      return a;
    }
    uint64_t c = take(node, entry, entered);
    if (entered == 0) {
      ChildKey::order(c, a);
      ChildKey::order(c, b);
      *top++ = c;
      *top++ = b;
      return a;
    }
    uint64_t d = take(node, entry, entered);
    ChildKey::order(d, c);
    ChildKey::order(d, b);
    ChildKey::order(c, a);
    ChildKey::order(c, b);
    uint64_t* const base = top;
    *top++ = d;
    *top++ = c;
    *top++ = b;
    if (entered == 0) return a;
    *top++ = a;
    do {
      *top++ = take(node, entry, entered);
    } while (entered != 0);
    sort(base, top);
    return *--top;
  }

  /// The same where any hit is enough: the largest, which stands first, then the second and so on.
  static HWY_INLINE uint64_t largest_of(const Node& node, const float* entry, uint32_t entered, uint64_t*& top) {
    const uint64_t first = take(node, entry, entered);
    if (entered == 0) return first;
    const uint64_t second = take(node, entry, entered);
    if (entered != 0) {
      const auto others = static_cast<uint32_t>(std::popcount(entered));
      top[0] = take_last(node, entry, entered);
      top[1] = take_last(node, entry, entered |= 1);  // some child if there is no other; it is not kept
      for (uint32_t i = 2; i < others; ++i) top[i] = take_last(node, entry, entered);
      top += others;
    }
    *top++ = second;
    return first;
  }

  static HWY_INLINE uint64_t take(const Node& node, const float* entry, uint32_t& entered) {
    const auto i = static_cast<uint32_t>(std::countr_zero(entered));
    entered &= entered - 1;
    return ChildKey::of(node.child[i].word, entry[i]);
  }

  static HWY_INLINE uint64_t take_last(const Node& node, const float* entry, uint32_t& entered) {
    const auto i = static_cast<uint32_t>(std::bit_width(entered) - 1);
    entered ^= 1U << i;
    return ChildKey::of(node.child[i].word, entry[i]);
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

  Visits visits_;
  const Tracer& tracer_;
  const Ray& ray_;
  const WideRay& wide_;
  NearestHit& nearest_;
  Counts& counts_;
};

#include "kerf/trace/rays_in_flight.h"
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
    const WideRay wide(ray, tracer.largest_coordinate);
    if (!wide.valid) return {};
    if constexpr (Counts::kCounts) {
      counts.count_boxes(1);
      if (!wide.enters(tracer.layout.bounds)) return {};
    }
    NearestHit nearest(wide.t_max);
    if (wide.is_usual) {
      Walk<Tree, true, kAny, Counts>(tracer, ray, wide, nearest, counts).run(tracer.layout.root);
    } else {
      Walk<Tree, false, kAny, Counts>(tracer, ray, wide, nearest, counts).run(tracer.layout.root);
    }
    if (!kAny) LeafVisits<Tree, kAny, Counts>::resolve(tracer, ray, wide, nearest);
    return finished(nearest.hit);
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

template <class Layout>
void WideTracer<Layout>::update() {
  const Vec3f sides = max(abs(layout.bounds.lower), abs(layout.bounds.upper));
  largest_coordinate = layout.is_empty() ? 0 : largest(sides);
  shared_mask = 0xFFFFFFFFU;
  for (const Geometry& geometry : geometries) shared_mask &= geometry.mask;
}
template struct WideTracer<WideBvh<4>>;
template struct WideTracer<WideBvh<8>>;
template struct WideTracer<QuantisedBvh>;

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
