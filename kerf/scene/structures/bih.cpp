#include "kerf/build/bih.h"

#include <utility>

#include "kerf/scene/structures/all.h"
#include "kerf/trace/trace_bih.h"
#include "kerf/tree/cell_slots.h"

namespace kerf {
namespace {

class BihStructure : public Structure {
 public:
  BihStructure(Bih bih, const StructureInput& input) : hash_(tree_hash(bih)) {
    tracer_.bih = std::move(bih);
    tracer_.geometries = input.geometries;
  }

  const TraceTable& table() const override { return bih_table(); }
  const void* data() const override { return &tracer_; }
  size_t bytes() const override { return tracer_.bih.bytes(); }
  uint64_t hash() const override { return hash_; }
  std::optional<std::string> find_fault() const override { return kerf::find_fault(tracer_.bih, tracer_.geometries); }

  /// A node's box is what the clip planes above it leave of the scene's, which is what a ray enters.
  void visit_nodes(const std::function<void(const NodeView&)>& visit) const override {
    if (!tracer_.bih.is_empty()) visit_node(0, tracer_.bih.bounds, 0, visit);
  }

 private:
  void visit_node(uint32_t number, const Box3f& box, uint32_t depth,
                  const std::function<void(const NodeView&)>& visit) const {
    const BihNode& node = tracer_.bih.nodes[number];
    const std::span<const LeafSlot> slots = tracer_.bih.slots;
    visit({box, depth, node.is_leaf(), node.is_leaf() ? slots.subspan(node.first(), node.count()) : slots.first(0)});
    if (node.is_leaf()) return;
    for (uint32_t side = 0; side < node.children(); ++side) {
      visit_node(node.child() + side, clipped_by(node, box, side), depth + 1, visit);
    }
  }

  BihTracer tracer_;
  uint64_t hash_;
};

}  // namespace

std::unique_ptr<const Structure> build_bih_structure(StructureInput input, const OptionValues& options) {
  input.held.release();
  Bih bih =
      build_bih(std::exchange(input.references, {}), TopDownOptions::from(options), options["cut_off"], input.limit);
  if (input.is_split) mark_repeated(bih.slots, input.geometries);
  return std::make_unique<const BihStructure>(std::move(bih), input);
}

}  // namespace kerf
