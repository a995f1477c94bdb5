#include "kerf/trace/brute_force.h"

#include "kerf/scene/structures/all.h"

namespace kerf {
namespace {

/// Every primitive in one leaf.
class BruteForceStructure : public Structure {
 public:
  explicit BruteForceStructure(const StructureInput& input) {
    slots_.reserve(input.references.size());
    for (const Reference& reference : input.references) {
      slots_.push_back({reference.geometry, reference.primitive});
      bounds_.extend(reference.bounds());
    }
    tracer_ = BruteForce(input.geometries, slots_);
    const HeldBytes held(slots_.size() * sizeof(LeafSlot) + tracer_.bytes());
  }

  const TraceTable& table() const override { return brute_force_table(); }
  const void* data() const override { return &tracer_; }
  size_t bytes() const override { return tracer_.bytes(); }
  uint64_t hash() const override { return 0; }
  std::string_view instruction_set() const override { return tracer_.instruction_set(); }

  std::optional<std::string> find_fault() const override {
    if (tracer_.size() == slots_.size()) return std::nullopt;
    return std::to_string(slots_.size()) + " primitives, but " + std::to_string(tracer_.size()) + " are tested";
  }

  void visit_nodes(const std::function<void(const NodeView&)>& visit) const override {
    if (!slots_.empty()) visit({bounds_, 0, true, slots_});
  }

 private:
  std::vector<LeafSlot> slots_;
  Box3f bounds_;
  BruteForce tracer_;
};

}  // namespace

std::unique_ptr<const Structure> build_brute_force(StructureInput input, const OptionValues&) {
  input.limit.check(input.references.size() * sizeof(LeafSlot));
  return std::make_unique<const BruteForceStructure>(input);
}

}  // namespace kerf
