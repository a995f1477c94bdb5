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

#include "kerf/trace/box_overlap.h"
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
#include "kerf/trace/rays_in_flight.h"
#include "kerf/trace/wide_stream.h"
#include "kerf/trace/wide_walk.h"

template <class Tree>
struct Kernel {
  using Tracer = WideTracer<typename Tree::Layout>;

  const Tracer& tracer;

  static Kernel at(const void* data) { return {*static_cast<const Tracer*>(data)}; }

  template <bool kAny>
  static detail::QueryResult<kAny> query(const void* data, const Ray& ray) {
    NoCounts counts;
    return static_cast<detail::QueryResult<kAny>>(at(data).template go<kAny>(ray, counts));
  }

  template <bool kAny, class Counts>
  Hit trace(const Ray& ray, Counts& counts) const {
    return go<kAny>(ray, counts);
  }

  template <bool kAny, class Counts>
  HWY_INLINE Hit go(const Ray& ray, Counts& counts) const {
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
