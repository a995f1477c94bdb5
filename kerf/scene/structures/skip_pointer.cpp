#include "kerf/layout/skip_pointer.h"

#include "kerf/scene/structures/all.h"
#include "kerf/trace/trace_skip_pointer.h"

namespace kerf {
namespace {

class SkipPointerStructure : public Structure {
 public:
  SkipPointerStructure(Bvh bvh, const StructureInput& input) : hash_(tree_hash(bvh)) {
    tracer_.layout = make_skip_pointer_bvh(std::move(bvh));
    tracer_.geometries = input.geometries;
  }

  const TraceTable& table() const override { return skip_pointer_table(); }
  const void* data() const override { return &tracer_; }
  size_t bytes() const override { return tracer_.layout.bytes(); }
  uint64_t hash() const override {
    if (hash_) return *hash_;
    const std::optional<Bvh> bvh = make_bvh(tracer_.layout);
    return bvh ? tree_hash(*bvh) : 0;
  }

  std::optional<std::string> find_fault() const override {
    return kerf::find_fault(tracer_.layout, tracer_.geometries, kLargestLeaf);
  }

  void visit_nodes(const std::function<void(const NodeView&)>& visit) const override {
    const std::span<const LeafSlot> slots = tracer_.layout.slots;
    std::vector<uint32_t> ends;  // of the subtrees that the node lies in
    for (uint32_t at = 0; at < tracer_.layout.nodes.size(); ++at) {
      while (!ends.empty() && ends.back() == at) ends.pop_back();
      const SkipPointerNode& node = tracer_.layout.nodes[at];
      visit({node.bounds(), static_cast<uint32_t>(ends.size()), node.is_leaf(),
             node.is_leaf() ? slots.subspan(node.first, node.count) : slots.first(0)});
      ends.push_back(tracer_.layout.after(at));
    }
  }

  RefitOutcome refit(const Fragments& fragments) override {
    hash_.reset();
    return kerf::refit(tracer_.layout, {fragments, tracer_.layout.slots, tracer_.geometries});
  }

 private:
  static constexpr uint32_t kLargestLeaf = 255;  // the most that a builder's option `leaf` allows

  std::optional<uint64_t> hash_;  ///< of the tree as it was built; none once it was refitted
  SkipPointerTracer tracer_;
};

}  // namespace

std::unique_ptr<Structure> make_skip_pointer_structure(Bvh bvh, const StructureInput& input, const OptionValues&) {
  input.limit.check(bvh.bytes());
  return std::make_unique<SkipPointerStructure>(std::move(bvh), input);
}

}  // namespace kerf
