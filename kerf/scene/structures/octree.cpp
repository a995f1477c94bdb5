#include "kerf/build/octree.h"

#include "kerf/scene/structures/all.h"
#include "kerf/trace/mailbox.h"
#include "kerf/trace/trace_octree.h"
#include "kerf/tree/cell_slots.h"

namespace kerf {
namespace {

/// An octree or a quadtree.
template <class Seen>
class OctreeStructure : public Structure {
 public:
  OctreeStructure(Octree tree, const StructureInput& input) : hash_(tree_hash(tree)) {
    tracer_.tree = std::move(tree);
    tracer_.geometries = input.geometries;
  }

  const TraceTable& table() const override { return octree_table(std::is_same_v<Seen, Mailbox>); }
  const void* data() const override { return &tracer_; }
  size_t bytes() const override { return tracer_.tree.bytes(); }
  uint64_t hash() const override { return hash_; }
  std::optional<std::string> find_fault() const override { return kerf::find_fault(tracer_.tree, tracer_.geometries); }

  void visit_nodes(const std::function<void(const NodeView&)>& visit) const override {
    if (!tracer_.tree.is_empty()) visit_cell(0, tracer_.tree.bounds, 0, visit);
  }

 private:
  void visit_cell(uint32_t number, const Box3f& cell, uint32_t depth,
                  const std::function<void(const NodeView&)>& visit) const {
    const Octree& tree = tracer_.tree;
    const OctreeNode& node = tree.nodes[number];
    const std::span<const LeafSlot> slots = tree.slots;
    visit({cell, depth, node.is_leaf(), node.is_leaf() ? slots.subspan(node.first, node.bits) : slots.first(0)});
    if (node.is_leaf()) return;
    uint32_t child = node.first;
    for (uint32_t octant = 0; octant < 8; ++octant) {
      if ((node.octants() >> octant & 1) != 0)
        visit_cell(child++, octant_of(cell, octant, tree.axes), depth + 1, visit);
    }
  }

  OctreeTracer<Seen> tracer_;
  uint64_t hash_;
};

std::unique_ptr<const Structure> build(const StructureInput& input, const OptionValues& options, int undivided) {
  const std::span<const Geometry> geometries = input.geometries;
  const OctreeOptions wanted{static_cast<uint32_t>(options["leaf"]), static_cast<uint32_t>(options["depth"]),
                             options["cap"], options.is_on("root"), undivided};
  Octree tree = build_octree(input.references, geometry_clipper(geometries), wanted, input.limit);
  mark_repeated(tree.slots, geometries);
  if (options.is_on("mailbox")) return std::make_unique<const OctreeStructure<Mailbox>>(std::move(tree), input);
  return std::make_unique<const OctreeStructure<NoMailbox>>(std::move(tree), input);
}

}  // namespace

std::unique_ptr<const Structure> build_octree_structure(StructureInput input, const OptionValues& options) {
  return build(input, options, -1);
}

std::unique_ptr<const Structure> build_quadtree_structure(StructureInput input, const OptionValues& options) {
  const auto axis = static_cast<uint32_t>(options["axis"]);  // x, y, z, shortest
  return build(input, options, static_cast<int>(axis < 3 ? axis : shortest_axis(input.references)));
}

}  // namespace kerf
