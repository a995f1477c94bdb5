#include <type_traits>

#include "kerf/layout/wide_refit.h"
#include "kerf/scene/structures/all.h"
#include "kerf/trace/trace_wide.h"

namespace kerf {
namespace {

/// A layout and its kernels.
template <class Layout>
class WideStructure : public Structure {
 public:
  WideStructure(const Bvh& bvh, const StructureInput& input, const WideCosts& costs)
      : kernels_(wide_kernels<Layout>()) {
    LeafNumbers* numbers = input.refittable && input.is_split ? &numbers_ : nullptr;
    if constexpr (kIsQuantised) {
      const CornerKind kind = input.refittable ? CornerKind::vertices : CornerKind::places;
      tracer_.layout = make_quantised_bvh(bvh, input.geometries, costs, kind, numbers);
    } else {
      tracer_.layout = make_wide_bvh<Layout::kChildren>(bvh, input.geometries, costs, numbers);
    }
    tracer_.geometries = input.geometries;
    tracer_.update();
  }

  const TraceTable& table() const override { return *kernels_.table; }
  const void* data() const override { return &tracer_; }
  std::string_view instruction_set() const override { return kernels_.instruction_set; }
  size_t bytes() const override { return tracer_.layout.bytes(); }
  uint64_t hash() const override { return tree_hash(tracer_.layout); }
  std::optional<std::string> find_fault() const override {
    return kerf::find_fault(tracer_.layout, tracer_.geometries);
  }

  void visit_nodes(const std::function<void(const NodeView&)>& visit) const override {
    std::vector<LeafSlot> slots;
    if (!tracer_.layout.is_empty()) visit_child(tracer_.layout.root, tracer_.layout.bounds, 0, slots, visit);
  }

  /// Of the boxes that rays meet, which in steps reach a little out of those around them. In the order of memory, which
  /// takes a fraction of the time of another visit.
  double cost() const override {
    const Layout& layout = tracer_.layout;
    const double root = half_area(layout.bounds);
    if (layout.is_empty() || !(root > 0)) return 0;
    const auto weight = [&](auto child) { return child.is_leaf() ? static_cast<double>(layout.slot_count(child)) : 1; };
    double sum = root * weight(layout.root);
    for (const auto& node : layout.nodes.span()) {
      for (uint32_t i = 0; i < Layout::kChildren && node.has_child(i); ++i) {
        sum += half_area(node.bounds(i)) * weight(node.child[i]);
      }
    }
    return sum / root;
  }

  RefitOutcome refit(const Fragments& fragments) override {
    const RefitOutcome outcome = kerf::refit(tracer_.layout, numbers_, fragments, tracer_.geometries);
    tracer_.update();
    return outcome;
  }
  size_t refit_bytes() const override { return numbers_.bytes(); }

 private:
  static constexpr bool kIsQuantised = std::is_same_v<Layout, QuantisedBvh>;

  /// `slots`: room for those of a leaf.
  void visit_child(typename Layout::Child child, const Box3f& bounds, uint32_t depth, std::vector<LeafSlot>& slots,
                   const std::function<void(const NodeView&)>& visit) const {
    if (child.is_leaf()) {
      tracer_.layout.read_slots(child, slots);
      return visit({bounds, depth, true, slots});
    }
    visit({bounds, depth, false, {}});
    const auto& node = tracer_.layout.nodes[child.number()];
    for (uint32_t i = 0; i < Layout::kChildren && node.has_child(i); ++i) {
      visit_child(node.child[i], intersected(bounds, node.bounds(i)), depth + 1, slots, visit);
    }
  }

  WideKernels kernels_;
  WideTracer<Layout> tracer_;
  LeafNumbers numbers_;
};

template <class Layout>
std::unique_ptr<Structure> make(Bvh bvh, const StructureInput& input, const OptionValues& options) {
  input.limit.check(bvh.bytes());
  WideCosts costs;
  costs.leaf = options["leaf_cost"];
  costs.triangle = options["triangle_cost"];
  return std::make_unique<WideStructure<Layout>>(bvh, input, costs);
}

}  // namespace

std::unique_ptr<Structure> make_bvh4_structure(Bvh bvh, const StructureInput& input, const OptionValues& options) {
  return make<WideBvh<4>>(std::move(bvh), input, options);
}
std::unique_ptr<Structure> make_bvh8_structure(Bvh bvh, const StructureInput& input, const OptionValues& options) {
  return make<WideBvh<8>>(std::move(bvh), input, options);
}
std::unique_ptr<Structure> make_quantised_bvh8_structure(Bvh bvh, const StructureInput& input,
                                                         const OptionValues& options) {
  return make<QuantisedBvh>(std::move(bvh), input, options);
}

}  // namespace kerf
