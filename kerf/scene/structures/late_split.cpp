#include "kerf/build/late_split.h"

#include "kerf/base/error.h"
#include "kerf/scene/structures/all.h"
#include "kerf/trace/trace_late_split.h"

namespace kerf {
namespace {

class LateSplitStructure : public Structure {
 public:
  LateSplitStructure(LateSplitBvh tree, std::span<const Geometry> geometries, bool restores)
      : tracer_{std::move(tree), geometries, restores}, hash_(tree_hash(tracer_.tree)) {}

  const TraceTable& table() const override { return late_split_table(); }
  const void* data() const override { return &tracer_; }
  size_t bytes() const override { return tracer_.tree.bytes(); }
  uint64_t hash() const override { return hash_; }
  std::optional<std::string> find_fault() const override { return kerf::find_fault(tracer_.tree, tracer_.geometries); }
  void visit_nodes(const std::function<void(const NodeView&)>& visit) const override {
    if (!tracer_.tree.is_empty()) visit_node(tracer_.tree.root, 0, visit);
  }

 private:
  void visit_node(const LateSplitNode& node, uint32_t depth, const std::function<void(const NodeView&)>& visit) const {
    const std::span<const LeafSlot> slots = tracer_.tree.slots;
    visit({node.bounds(), depth, node.is_leaf(), node.is_leaf() ? slots.subspan(node.first, 1) : slots.first(0)});
    if (node.is_leaf()) return;
    for (const LateSplitNode& child : tracer_.tree.pairs[node.first].child) visit_node(child, depth + 1, visit);
  }

  LateSplitTracer tracer_;
  uint64_t hash_;
};

}  // namespace

std::unique_ptr<Structure> make_late_split_structure(Bvh bvh, const StructureInput& input,
                                                     const OptionValues& options) {
  if (options.is_set("budget") && (options.is_set("sa_max") || options.is_set("cap"))) {
    throw Error(ErrorCode::invalid_option, "late_split", "budget replaces sa_max and cap: give one or the other");
  }
  const EarlySplit limits = options.is_set("budget") ? EarlySplit::with_budget(options["budget"])
                                                     : EarlySplit{options["sa_max"], options["cap"]};
  LateSplitBvh tree = build_late_split(bvh, geometry_clipper(input.geometries), limits, input.limit);
  return std::make_unique<LateSplitStructure>(std::move(tree), input.geometries, options.is_on("restore"));
}

}  // namespace kerf
