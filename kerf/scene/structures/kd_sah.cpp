#include "kerf/build/kd_builder.h"
#include "kerf/scene/structures/all.h"
#include "kerf/trace/trace_kd.h"

namespace kerf {
namespace {

template <bool kMailbox>
class KdStructure : public Structure {
 public:
  KdStructure(KdTree tree, std::span<const Geometry> geometries, bool boxes_only, uint32_t max_depth)
      : tracer_{std::move(tree), geometries}, boxes_only_(boxes_only), max_depth_(max_depth) {}

  const TraceTable& table() const override { return kd_table<kMailbox>(); }
  const void* data() const override { return &tracer_; }
  size_t bytes() const override { return tracer_.tree.bytes(); }
  uint64_t hash() const override { return tree_hash(tracer_.tree); }

  std::optional<std::string> find_fault() const override {
    return kerf::find_fault(tracer_.tree, tracer_.geometries, boxes_only_, max_depth_);
  }

  void visit_nodes(const std::function<void(const NodeView&)>& visit) const override {
    const KdTree& tree = tracer_.tree;
    const std::span<const LeafSlot> slots = tree.slots;
    visit_cells(tree, [&](uint32_t number, const Box3f& cell, uint32_t depth) {
      const KdNode& node = tree.nodes[number];
      const bool is_leaf = node.is_leaf();
      visit({cell, depth, is_leaf, is_leaf ? slots.subspan(node.first(), node.count()) : slots.first(0)});
    });
  }

 private:
  KdTracer<kMailbox> tracer_;
  bool boxes_only_;
  uint32_t max_depth_;
};

}  // namespace

std::unique_ptr<const Structure> build_kd_sah(StructureInput input, const OptionValues& options) {
  KdOptions kd;
  kd.is_sampled = options.is_on("build");
  kd.clips = options.is_on("clip");
  kd.costs = {options["traversal_cost"], options["primitive_cost"], options["empty_bonus"]};
  kd.leaf_size = static_cast<uint32_t>(options["leaf"]);
  kd.max_depth = static_cast<uint32_t>(options["depth"]);
  kd.tries = options.is_on("trial");
  kd.cap = options["cap"];
  kd.samples = static_cast<uint32_t>(options["samples"]);
  input.held.release();
  KdTree tree = build_kd_tree(std::move(input.references), geometry_clipper(input.geometries), kd, input.limit);
  mark_repeated(tree, input.geometries);
  const bool boxes_only = !kd.clips;
  const uint32_t max_depth = kd.max_depth > 0 ? kd.max_depth : kMaxDepth;
  if (options.is_on("mailbox")) {
    return std::make_unique<const KdStructure<true>>(std::move(tree), input.geometries, boxes_only, max_depth);
  }
  return std::make_unique<const KdStructure<false>>(std::move(tree), input.geometries, boxes_only, max_depth);
}

}  // namespace kerf
