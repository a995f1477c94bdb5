// Split references without Kerf's trees: kerf::split_references() cuts the large triangles of a mesh, Embree's own
// builder, rtcBuildBVH(), makes a tree of them. Prints what splitting changes, and checks that rays through Embree's
// tree hit what they hit in a kerf::Scene.

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <random>
#include <vector>

#include "kerf/references/split_references.h"
#include "kerf/scene/scene.h"

namespace {

// A Reference is what Embree takes, field by field.
static_assert(sizeof(kerf::Reference) == sizeof(RTCBuildPrimitive));
static_assert(offsetof(kerf::Reference, lower) == offsetof(RTCBuildPrimitive, lower_x));
static_assert(offsetof(kerf::Reference, geometry) == offsetof(RTCBuildPrimitive, geomID));
static_assert(offsetof(kerf::Reference, upper) == offsetof(RTCBuildPrimitive, upper_x));
static_assert(offsetof(kerf::Reference, primitive) == offsetof(RTCBuildPrimitive, primID));

constexpr unsigned kLeafSize = 4;

/// A node of the tree that Embree's callbacks make. Embree keeps the boxes of the children with their parent.
struct Node {
  kerf::Box3f bounds[2];
  Node* children[2] = {nullptr, nullptr};
  unsigned count = 0;  ///< of triangles; 0 for an inner node
  unsigned triangles[kLeafSize] = {};
};

void* create_node(RTCThreadLocalAllocator allocator, unsigned, void*) {
  return new (rtcThreadLocalAlloc(allocator, sizeof(Node), alignof(Node))) Node;
}

void set_children(void* node, void** children, unsigned count, void*) {
  for (unsigned i = 0; i < count; ++i) static_cast<Node*>(node)->children[i] = static_cast<Node*>(children[i]);
}

void set_bounds(void* node, const RTCBounds** bounds, unsigned count, void*) {
  for (unsigned i = 0; i < count; ++i) {
    const RTCBounds& b = *bounds[i];
    static_cast<Node*>(node)->bounds[i] = {{b.lower_x, b.lower_y, b.lower_z}, {b.upper_x, b.upper_y, b.upper_z}};
  }
}

void* create_leaf(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* primitives, size_t count, void*) {
  Node* leaf = new (rtcThreadLocalAlloc(allocator, sizeof(Node), alignof(Node))) Node;
  leaf->count = static_cast<unsigned>(count);
  for (size_t i = 0; i < count; ++i) leaf->triangles[i] = primitives[i].primID;
  return leaf;
}

/// Embree's tree over references; `bvh` owns the nodes.
Node* build(RTCBVH bvh, const std::vector<kerf::Reference>& references) {
  // A copy: the builder sorts what it is given, and wants it aligned to 32 bytes.
  std::vector<RTCBuildPrimitive> primitives;
  primitives.reserve(references.size());
  for (const kerf::Reference& reference : references) primitives.push_back(std::bit_cast<RTCBuildPrimitive>(reference));
  RTCBuildArguments arguments = rtcDefaultBuildArguments();
  arguments.maxLeafSize = kLeafSize;
  arguments.bvh = bvh;
  arguments.primitives = primitives.data();
  arguments.primitiveCount = arguments.primitiveArrayCapacity = primitives.size();
  arguments.createNode = create_node;
  arguments.setNodeChildren = set_children;
  arguments.setNodeBounds = set_bounds;
  arguments.createLeaf = create_leaf;
  return static_cast<Node*>(rtcBuildBVH(&arguments));
}

/// The sum over nodes of area, times the number of triangles in a leaf, as kerf::sah_cost() before it is divided by the
/// area of the root.
double weighted_area(const Node& node, const kerf::Box3f& bounds) {
  const double area = kerf::surface_area(bounds);
  if (node.count > 0) return area * node.count;
  return area + weighted_area(*node.children[0], node.bounds[0]) + weighted_area(*node.children[1], node.bounds[1]);
}

/// Whether the ray's line enters the box before the nearest hit so far, with room for rounding.
bool enters(const kerf::Box3f& box, const kerf::Ray& ray, float limit) {
  double near = ray.t_min, far = limit;
  for (uint32_t axis = 0; axis < 3; ++axis) {
    const double a = (static_cast<double>(box.lower[axis]) - ray.origin[axis]) / ray.direction[axis];
    const double b = (static_cast<double>(box.upper[axis]) - ray.origin[axis]) / ray.direction[axis];
    near = std::max(near, std::min(a, b));
    far = std::min(far, std::max(a, b));
  }
  return near <= far + 1e-5 * std::abs(far);
}

/// What one tree costs to trace, and the nearest hit through it, with Kerf's own triangle test.
struct Tracer {
  const kerf::Geometry& geometry;
  const Node& root;
  size_t tests = 0;

  kerf::Hit closest_hit(const kerf::Ray& ray) {
    kerf::Hit hit;
    visit(root, ray, kerf::PreparedRay(ray), hit);
    return hit;
  }

  void visit(const Node& node, const kerf::Ray& ray, const kerf::PreparedRay& prepared, kerf::Hit& hit) {
    for (unsigned i = 0; i < node.count; ++i) {
      ++tests;
      kerf::Crossing c;
      if (!kerf::intersect(geometry, node.triangles[i], prepared, std::min(ray.t_max, hit.t), c)) continue;
      const kerf::Hit found{.t = c.t, .u = c.u, .v = c.v, .primitive = node.triangles[i], .geometry = 0};
      if (kerf::closer(found, hit)) hit = found;
    }
    if (node.count > 0) return;
    for (int i = 0; i < 2; ++i) {
      if (enters(node.bounds[i], ray, std::min(ray.t_max, hit.t))) visit(*node.children[i], ray, prepared, hit);
    }
  }
};

/// Long thin triangles that lie askew, the kind that a box fits worst.
struct Sticks {
  std::vector<kerf::Vec3f> vertices;
  std::vector<kerf::TriangleCorners> triangles;
};

Sticks make_sticks(uint32_t count, std::mt19937& random) {
  Sticks sticks;
  sticks.vertices.reserve(size_t{3} * count);
  sticks.triangles.reserve(count);
  const auto number = [&] { return static_cast<float>(random()) / 0x1p32F * 2 - 1; };
  for (uint32_t i = 0; i < count; ++i) {
    const kerf::Vec3f a{number(), number(), number()}, along{number(), number(), number()};
    const kerf::Vec3f across{0.02F * number(), 0.02F * number(), 0.02F * number()};
    sticks.vertices.insert(sticks.vertices.end(), {a, a + along, a + across});
    sticks.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return sticks;
}

}  // namespace

int main() {
  std::mt19937 random(7);
  const Sticks sticks = make_sticks(2000, random);
  const kerf::TriangleMesh mesh{sticks.vertices, sticks.triangles};
  const kerf::Geometry geometry{mesh};
  kerf::Scene scene;
  scene.add(mesh);
  scene.build();
  std::vector<kerf::Ray> rays(20000);
  const auto number = [&] { return static_cast<float>(random()) / 0x1p32F * 2 - 1; };
  for (kerf::Ray& ray : rays) {
    ray = {.origin = {number(), number(), 3}, .direction = {0.5F * number(), 0.5F * number(), -1}};
  }

  const RTCDevice device = rtcNewDevice(nullptr);
  std::printf("%-8s %11s %9s %11s %7s %7s\n", "budget", "references", "SAH cost", "tests/ray", "hits", "differ");
  size_t all_different = 0;
  for (const double budget : {1.0, 1.5, 2.0, 4.0}) {
    const auto references = kerf::split_references(mesh, kerf::EarlySplit::with_budget(budget));
    const RTCBVH bvh = rtcNewBVH(device);
    const Node* root = build(bvh, references);
    if (root == nullptr) return EXIT_FAILURE;
    kerf::Box3f bounds;
    for (const kerf::Reference& reference : references) bounds.extend(reference.bounds());
    Tracer tracer{geometry, *root};
    size_t hits = 0, different = 0;
    for (const kerf::Ray& ray : rays) {
      const kerf::Hit hit = tracer.closest_hit(ray);
      hits += hit ? 1 : 0;
      different += hit == scene.closest_hit(ray) ? 0 : 1;
    }
    std::printf("%-8g %11zu %9.2f %11.2f %7zu %7zu\n", budget, references.size(),
                weighted_area(*root, bounds) / kerf::surface_area(bounds),
                static_cast<double>(tracer.tests) / static_cast<double>(rays.size()), hits, different);
    rtcReleaseBVH(bvh);
    all_different += different;
  }
  rtcReleaseDevice(device);
  return all_different == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
