#include "kerf/study/embree_builder.h"

#ifdef KERF_HAVE_EMBREE

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <string>

#include "kerf/base/error.h"
#include "kerf/base/parallel.h"
#include "kerf/scene/menu.h"
#include "kerf/study/embree_calls.h"

namespace kerf {
namespace {

/// A node in Embree's memory: an inner one, or a leaf that its `count` reference numbers and boxes follow.
struct EmbreeNode {
  EmbreeNode* child[2];
  uint32_t count;  ///< 0: an inner node
};

/// A slot of a leaf: the reference and the box of the piece of it.
struct EmbreeSlot {
  uint32_t reference;
  Box3f bounds;
};

EmbreeSlot* slots_of(EmbreeNode* leaf) { return reinterpret_cast<EmbreeSlot*>(leaf + 1); }

/// What the callbacks work on. Nothing may be thrown through Embree: what goes wrong is kept for after the build.
struct EmbreeBuild {
  std::span<const Reference> references;
  Clipper clipper;
  WorkLimit limit;
  std::exception_ptr failure;
};

void* create_node(RTCThreadLocalAllocator allocator, unsigned int, void*) {
  return new (rtcThreadLocalAlloc(allocator, sizeof(EmbreeNode), alignof(EmbreeNode))) EmbreeNode{};
}

void set_children(void* node, void** children, unsigned int count, void*) {
  for (unsigned int i = 0; i < count; ++i)
    static_cast<EmbreeNode*>(node)->child[i] = static_cast<EmbreeNode*>(children[i]);
}

/// The boxes follow from the leaves.
void set_bounds(void*, const RTCBounds**, unsigned int, void*) {}

void* create_leaf(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* primitives, size_t count, void*) {
  void* memory = rtcThreadLocalAlloc(allocator, sizeof(EmbreeNode) + count * sizeof(EmbreeSlot), alignof(EmbreeNode));
  auto* leaf = new (memory) EmbreeNode{{}, static_cast<uint32_t>(count)};
  for (size_t i = 0; i < count; ++i) {
    const RTCBuildPrimitive& p = primitives[i];
    new (slots_of(leaf) + i)
        EmbreeSlot{p.primID, {{p.lower_x, p.lower_y, p.lower_z}, {p.upper_x, p.upper_y, p.upper_z}}};
  }
  return leaf;
}

RTCBounds to_embree(const Box3f& box) {
  RTCBounds bounds{};
  bounds.lower_x = box.lower.x;
  bounds.lower_y = box.lower.y;
  bounds.lower_z = box.lower.z;
  bounds.upper_x = box.upper.x;
  bounds.upper_y = box.upper.y;
  bounds.upper_z = box.upper.z;
  return bounds;
}

Box3f flattened(Box3f box, uint32_t axis, float position) {
  box.lower[axis] = box.upper[axis] = position;
  return box;
}

/// Our clip. geomID is not ours at this time: Embree keeps the number of splits allowed in it.
void split_primitive(const RTCBuildPrimitive* primitive, unsigned int axis, float position, RTCBounds* below,
                     RTCBounds* above, void* data) {
  const auto& build = *static_cast<EmbreeBuild*>(data);
  Reference piece = build.references[primitive->primID];
  piece.lower = {primitive->lower_x, primitive->lower_y, primitive->lower_z};
  piece.upper = {primitive->upper_x, primitive->upper_y, primitive->upper_z};
  ClippedBoxes boxes = build.clipper(piece, axis, position);
  // A piece's box may reach over a plane that the primitive in it does not. Embree ends the program where all that it
  // counted on one side turns out empty, so that side gets a face of the other's box.
  if (boxes.below.is_empty())
    boxes.below = flattened(boxes.above.is_empty() ? piece.bounds() : boxes.above, axis, position);
  if (boxes.above.is_empty()) boxes.above = flattened(boxes.below, axis, position);
  *below = to_embree(boxes.below);
  *above = to_embree(boxes.above);
}

bool report_progress(void* data, double) {
  auto& build = *static_cast<EmbreeBuild*>(data);
  try {
    build.limit.check();
    return true;
  } catch (...) {
    build.failure = std::current_exception();
    return false;
  }
}

/// Turns Embree's tree into ours.
class Takeover {
 public:
  explicit Takeover(std::span<const Reference> references) : references_(references) {}

  Bvh take(EmbreeNode* root) {
    bvh_.nodes.emplace_back();
    take(root, 0, 0);
    return std::move(bvh_);
  }

 private:
  void take(EmbreeNode* from, uint32_t to, uint32_t depth) {
    if (depth > kMaxDepth) throw Error(ErrorCode::too_large, "embree", "its tree is too deep");
    Box3f bounds;
    const auto first = static_cast<uint32_t>(from->count > 0 ? bvh_.slots.size() : bvh_.nodes.size());
    if (from->count > 0) {
      for (const EmbreeSlot& slot : std::span(slots_of(from), from->count)) {
        const Reference& reference = references_[slot.reference];
        bvh_.slots.push_back({reference.geometry, reference.primitive});
        bounds.extend(slot.bounds);
      }
    } else {
      bvh_.nodes.resize(bvh_.nodes.size() + 2);
      for (uint32_t i = 0; i < 2; ++i) {
        take(from->child[i], first + i, depth + 1);
        bounds.extend(bvh_.nodes[first + i].bounds());
      }
    }
    bvh_.nodes[to] = {bounds.lower, first, bounds.upper, from->count};
  }

  std::span<const Reference> references_;
  Bvh bvh_;
};

/// A device on the calling thread and an empty tree. rtcGetDeviceError() tells of the last call that failed.
struct EmbreeHandles {
  RTCDevice device = rtcNewDevice("threads=1,set_affinity=0");
  RTCBVH bvh = device != nullptr ? rtcNewBVH(device) : nullptr;

  EmbreeHandles() = default;
  EmbreeHandles(const EmbreeHandles&) = delete;
  EmbreeHandles& operator=(const EmbreeHandles&) = delete;
  ~EmbreeHandles() {
    if (bvh != nullptr) rtcReleaseBVH(bvh);
    if (device != nullptr) rtcReleaseDevice(device);
  }
};

/// Embree's primitives stand on 32 bytes.
struct alignas(32) EmbreePrimitive : RTCBuildPrimitive {};
static_assert(sizeof(EmbreePrimitive) == 32);

Bvh build(BuildInput input, const OptionValues& options, RTCBuildQuality quality, double budget) {
  const size_t count = input.references.size();
  if (count == 0) return {};
  const size_t capacity = std::min(kMaxReferences, static_cast<size_t>(std::ceil(budget * static_cast<double>(count))));
  input.limit.check(capacity * (sizeof(EmbreePrimitive) + sizeof(EmbreeSlot) + 2 * sizeof(EmbreeNode)));
  std::vector<EmbreePrimitive> primitives(capacity);
  for (size_t i = 0; i < count; ++i) {
    const Reference& r = input.references[i];
    primitives[i] = {{r.lower.x, r.lower.y, r.lower.z, 0, r.upper.x, r.upper.y, r.upper.z, static_cast<uint32_t>(i)}};
  }
  const EmbreeHandles embree;
  EmbreeBuild work{input.references, input.clipper, input.limit, nullptr};
  RTCBuildArguments arguments = rtcDefaultBuildArguments();
  arguments.buildQuality = quality;
  arguments.maxBranchingFactor = 2;
  arguments.maxDepth = kMaxDepth;
  arguments.maxLeafSize = static_cast<unsigned int>(options["leaf"]);
  arguments.traversalCost = 1;
  arguments.intersectionCost = 1;
  arguments.bvh = embree.bvh;
  arguments.primitives = primitives.data();
  arguments.primitiveCount = count;
  arguments.primitiveArrayCapacity = capacity;
  arguments.createNode = create_node;
  arguments.setNodeChildren = set_children;
  arguments.setNodeBounds = set_bounds;
  arguments.createLeaf = create_leaf;
  arguments.splitPrimitive = quality == RTC_BUILD_QUALITY_HIGH ? split_primitive : nullptr;
  arguments.buildProgress = report_progress;
  arguments.userPtr = &work;
  void* root = nullptr;
  if (embree.bvh != nullptr) with_threads(1, [&] { root = rtcBuildBVH(&arguments); });
  if (work.failure) std::rethrow_exception(work.failure);
  if (root == nullptr) {
    throw Error(ErrorCode::too_large, "embree",
                "it refused to build, error " + std::to_string(rtcGetDeviceError(embree.device)));
  }
  return Takeover(input.references).take(static_cast<EmbreeNode*>(root));
}

constexpr OptionSpec kLeaf = {"leaf", "references in a leaf, at most", 4, 1, RTC_BUILD_MAX_PRIMITIVES_PER_LEAF, true};
constexpr OptionSpec kMediumOptions[] = {kLeaf};
constexpr OptionSpec kHighOptions[] = {
    kLeaf, {"budget", "references that Embree may make, for each one that it gets", 2, 1, 16}};

constexpr BuilderEntry kMedium = {
    "embree_medium", "Embree's binned build, built on one thread",
    "Wald, Woop, Benthin, Johnson, Ernst: Embree, a Kernel Framework for Efficient CPU Ray Tracing, 2014",
    kMediumOptions, [](BuildInput input, const OptionValues& options) {
      return build(std::move(input), options, RTC_BUILD_QUALITY_MEDIUM, 1);
    }};
constexpr BuilderEntry kHigh = {
    "embree_high", "Embree's build with spatial splits, built on one thread",
    "Wald, Woop, Benthin, Johnson, Ernst: Embree, a Kernel Framework for Efficient CPU Ray Tracing, 2014", kHighOptions,
    [](BuildInput input, const OptionValues& options) {
      return build(std::move(input), options, RTC_BUILD_QUALITY_HIGH, options["budget"]);
    }};

}  // namespace

bool has_embree() { return true; }

void add_embree_builders() {
  add_to_menu(kMedium);
  add_to_menu(kHigh);
}

}  // namespace kerf

#else

namespace kerf {

bool has_embree() { return false; }
void add_embree_builders() {}

}  // namespace kerf

#endif
