// kerf_bench_watertight_nodes: the walk through a bvh8, once as it is, with constants of the ray that enlarge boxes,
// and once with the plain slab test, which has one inverse for each axis and may miss boxes. Leaves are visited but not
// tested, so that both go all the way. To be run by watertight_nodes.sh, which counts the instructions.

#include <cinttypes>
#include <cstdio>
#include <vector>

// The very kernels, once more and for AVX2 only, for callgrind knows nothing beyond it.
#define HWY_COMPILE_ONLY_STATIC
#define wide_kernels wide_kernels_of_this_program  // NOLINT(readability-identifier-naming)
#include "kerf/trace/trace_wide.cpp"               // NOLINT(bugprone-suspicious-include)
//
#include "kerf/build/builders.h"
#include "kerf/references/reference.h"
#include "tests/support/random.h"
#include "tests/support/random_scene.h"

namespace kerf::HWY_NAMESPACE {
namespace {

struct NoLeafTests {
  const WideRay& ray;
  static Found find(const TriangleLeaf&, float, Between&) { return {}; }
};

/// BoxTests without what makes it watertight.
template <bool kFused>
struct PlainBoxTests {
  static constexpr uint32_t kWidth = 8;
  using Lanes = hn::CappedTag<float, kWidth>;
  using V = hn::Vec<Lanes>;
  static_assert(hn::MaxLanes(Lanes()) == kWidth);

  V inverse_x, inverse_y, inverse_z, origin_x, origin_y, origin_z, t_min;
  const SideRows& rows;

  explicit PlainBoxTests(const WideRay& ray)
      : inverse_x(all(-ray.inverse[0])),
        inverse_y(all(-ray.inverse[1])),
        inverse_z(all(-ray.inverse[2])),
        origin_x(all(ray.origin[0])),
        origin_y(all(ray.origin[1])),
        origin_z(all(ray.origin[2])),
        t_min(all(ray.t_min)),
        rows(kSideRows<kWidth, 2>.by_octant[ray.octant]) {}

  HWY_INLINE uint32_t enter(const WideNode<kWidth>& node, float limit, float* entry) const {
    const Lanes d;
    const float* const sides = &node.sides[0][0][0];
    const auto x0 = at(sides + rows.near[0], origin_x, inverse_x);
    const auto x1 = at(sides + rows.far[0], origin_x, inverse_x);
    const auto y0 = at(sides + rows.near[1], origin_y, inverse_y);
    const auto y1 = at(sides + rows.far[1], origin_y, inverse_y);
    const auto z0 = at(sides + rows.near[2], origin_z, inverse_z);
    const auto z1 = at(sides + rows.far[2], origin_z, inverse_z);
    V near;
    const uint32_t entered = overlap<true>(d, {x0, y0, z0, t_min}, {x1, y1, z1, hn::Set(d, limit)}, near);
    hn::Store(near, d, entry);
    return entered;
  }

 private:
  static HWY_INLINE V all(float value) { return hn::Set(Lanes(), value); }
  static HWY_INLINE V at(const float* sides, V origin, V inverse) {
    return hn::Mul(hn::Sub(origin, hn::Load(Lanes(), sides)), inverse);
  }
};

struct WatertightTree : WideTree<8> {
  using Leaves = NoLeafTests;
};
struct PlainTree : WatertightTree {
  template <bool kFused>
  using Boxes = PlainBoxTests<kFused>;
};

struct Rays {
  std::vector<Ray> rays;
  std::vector<WideRay> wide;
};

template <class Tree, class Counts>
HWY_INLINE void walk(const WideTracer<WideBvh<8>>& tracer, const Rays& rays, WideChild from, Counts& counts) {
  for (size_t i = 0; i < rays.rays.size(); ++i) {
    NearestHit nearest(rays.wide[i].t_max);
    Walk<Tree, true, false, Counts>(tracer, rays.rays[i], rays.wide[i], nearest, counts).run(from);
  }
}

// What callgrind counts, by name. The ways to a single leaf are what is there for each ray, not for each node.
HWY_NOINLINE void walk_watertight(const WideTracer<WideBvh<8>>& tracer, const Rays& rays) {
  NoCounts none;
  walk<WatertightTree>(tracer, rays, tracer.layout.root, none);
}
HWY_NOINLINE void walk_plain(const WideTracer<WideBvh<8>>& tracer, const Rays& rays) {
  NoCounts none;
  walk<PlainTree>(tracer, rays, tracer.layout.root, none);
}
HWY_NOINLINE void start_watertight(const WideTracer<WideBvh<8>>& tracer, const Rays& rays, WideChild leaf) {
  NoCounts none;
  walk<WatertightTree>(tracer, rays, leaf, none);
}
HWY_NOINLINE void start_plain(const WideTracer<WideBvh<8>>& tracer, const Rays& rays, WideChild leaf) {
  NoCounts none;
  walk<PlainTree>(tracer, rays, leaf, none);
}

int run() {
  constexpr uint32_t kTriangles = 30'000;
  constexpr size_t kRays = 3000;
  const test::RandomTriangles triangles(kTriangles);
  const std::vector<Geometry> geometries{triangles.geometry()};
  const BuilderEntry& builder = *std::find_if(builders().begin(), builders().end(),
                                              [](const BuilderEntry& entry) { return entry.name == "binned_sah"; });
  Bvh bvh = builder.build(make_references(geometries).references, OptionValues(builder.options));
  mark_repeated(bvh, geometries);
  WideTracer<WideBvh<8>> tracer{make_wide_bvh<8>(bvh, geometries), geometries};
  tracer.update();
  test::Random random(1);
  Rays rays;
  for (size_t i = 0; i < kRays; ++i) {
    const Ray ray{.origin = 10.0F * random.vector(), .direction = random.vector()};
    rays.rays.push_back(ray);
    rays.wide.emplace_back(ray, tracer.largest_coordinate);
    if (!rays.wide.back().is_usual) return 1;
  }
  TraceCounts watertight, plain;
  walk<WatertightTree>(tracer, rays, tracer.layout.root, watertight);
  walk<PlainTree>(tracer, rays, tracer.layout.root, plain);
  std::printf("rays\t%zu\nnodes_watertight\t%" PRIu64 "\nnodes_plain\t%" PRIu64 "\n", kRays, watertight.nodes,
              plain.nodes);
  WideChild leaf;
  for (size_t i = 0; i < tracer.layout.nodes.size() && !leaf.is_leaf(); ++i) leaf = tracer.layout.nodes[i].child[0];
  walk_watertight(tracer, rays);
  walk_plain(tracer, rays);
  start_watertight(tracer, rays, leaf);
  start_plain(tracer, rays, leaf);
  return 0;
}

}  // namespace
}  // namespace kerf::HWY_NAMESPACE

int main() { return kerf::HWY_NAMESPACE::run(); }
