#include "kerf/build/bsp_sah.h"

#include "kerf/scene/structures/all.h"
#include "kerf/trace/trace_bsp.h"

namespace kerf {
namespace {

class BspStructure : public Structure {
 public:
  BspStructure(BspTree tree, std::span<const Geometry> geometries)
      : tracer_{std::move(tree), geometries}, hash_(tree_hash(tracer_.tree)) {}

  const TraceTable& table() const override { return bsp_table(); }
  const void* data() const override { return &tracer_; }
  size_t bytes() const override { return tracer_.tree.bytes(); }
  uint64_t hash() const override { return hash_; }
  std::optional<std::string> find_fault() const override { return kerf::find_fault(tracer_.tree, tracer_.geometries); }
  void visit_nodes(const std::function<void(const NodeView&)>& visit) const override {
    if (!tracer_.tree.nodes.empty()) visit_node(0, 0, visit);
  }
  double cost() const override { return sah_cost(tracer_.tree); }

 private:
  void visit_node(uint32_t number, uint32_t depth, const std::function<void(const NodeView&)>& visit) const {
    const BspNode& node = tracer_.tree.nodes[number];
    const std::span<const LeafSlot> slots = tracer_.tree.slots;
    visit({tracer_.tree.cells[number].bounds, depth, node.is_leaf(),
           node.is_leaf() ? slots.subspan(node.first, node.count) : slots.first(0)});
    if (node.is_leaf()) return;
    visit_node(node.first, depth + 1, visit);
    visit_node(node.first + 1, depth + 1, visit);
  }

  BspTracer tracer_;
  uint64_t hash_;
};

}  // namespace

std::unique_ptr<const Structure> build_bsp_structure(StructureInput input, const OptionValues& options) {
  BspTree tree = build_bsp_sah(input.geometries, input.references, BspOptions::from(options), input.limit);
  return std::make_unique<const BspStructure>(std::move(tree), input.geometries);
}

}  // namespace kerf
