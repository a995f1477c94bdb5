#pragma once

#include "kerf/layout/bvh2.h"
#include "kerf/scene/structure.h"

namespace kerf {

/// A Bvh2 with the tracer that works on it.
template <class Tracer>
class Bvh2Structure : public Structure {
 public:
  Bvh2Structure(Bvh bvh, const StructureInput& input, const Tracer& tracer = {})
      : hash_(tree_hash(bvh)), tracer_(tracer) {
    tracer_.layout = make_bvh2(std::move(bvh));
    tracer_.geometries = input.geometries;
  }

  const TraceTable& table() const override { return Tracer::table(); }
  const void* data() const override { return &tracer_; }
  size_t bytes() const override { return tracer_.layout.bytes(); }
  uint64_t hash() const override { return hash_ ? *hash_ : tree_hash(make_bvh(tracer_.layout)); }

  std::optional<std::string> find_fault() const override {
    const Bvh bvh = make_bvh(tracer_.layout);
    if (hash_ && tree_hash(bvh) != *hash_) return "it is not the tree that it was made from";
    return kerf::find_fault(bvh, tracer_.geometries, kLargestLeaf);
  }

  void visit_nodes(const std::function<void(const NodeView&)>& visit) const override {
    if (!tracer_.layout.is_empty()) visit_child(tracer_.layout.root, 0, visit);
  }

  RefitOutcome refit(const Fragments& fragments) override {
    hash_.reset();
    return kerf::refit(tracer_.layout, {fragments, tracer_.layout.slots, tracer_.geometries});
  }

 protected:
  Tracer& tracer() { return tracer_; }
  const Tracer& tracer() const { return tracer_; }

 private:
  static constexpr uint32_t kLargestLeaf = 255;  // the most that a builder's option `leaf` allows

  void visit_child(const Bvh2Child& child, uint32_t depth, const std::function<void(const NodeView&)>& visit) const {
    const std::span<const LeafSlot> slots = tracer_.layout.slots;
    const bool is_leaf = child.is_leaf();
    visit({child.bounds(), depth, is_leaf, is_leaf ? slots.subspan(child.first, child.count) : slots.first(0)});
    if (is_leaf) return;
    for (const Bvh2Child& below : tracer_.layout.nodes[child.first].child) visit_child(below, depth + 1, visit);
  }

  std::optional<uint64_t> hash_;  ///< of the tree as it was built; none once it was refitted
  Tracer tracer_;
};

}  // namespace kerf
