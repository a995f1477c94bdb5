#include "kerf/scene/structures/all.h"
#include "kerf/scene/structures/bvh2_structure.h"
#include "kerf/trace/trace_bvh2.h"

namespace kerf {
namespace {

using AxisTracer = Bvh2TracerOf<ChildOrder::axis, BoxRay>;

/// Its inner nodes have axes in them, which are to be right as well.
class AxisStructure : public Bvh2Structure<AxisTracer> {
 public:
  AxisStructure(Bvh bvh, const StructureInput& input) : Bvh2Structure(std::move(bvh), input) {
    mark_axes(tracer().layout);
  }

  std::optional<std::string> find_fault() const override {
    const std::optional<std::string> fault = Bvh2Structure::find_fault();
    return fault ? fault : find_axis_fault(tracer().layout);
  }

  RefitOutcome refit(const Fragments& fragments) override {
    const RefitOutcome outcome = Bvh2Structure::refit(fragments);
    mark_axes(tracer().layout);
    return outcome;
  }
};

using Maker = std::unique_ptr<Structure> (*)(Bvh bvh, const StructureInput& input);

template <class Made>
std::unique_ptr<Structure> make(Bvh bvh, const StructureInput& input) {
  return std::make_unique<Made>(std::move(bvh), input);
}

template <ChildOrder kOrder, class BoxTest>
constexpr Maker kMake = make<Bvh2Structure<Bvh2TracerOf<kOrder, BoxTest>>>;

// In the order of the words in all.h.
constexpr Maker kByOrder[] = {kMake<ChildOrder::entry, BoxRay>, kMake<ChildOrder::fixed, BoxRay>, make<AxisStructure>,
                              kMake<ChildOrder::heap, BoxRay>};
constexpr Maker kByBoxTest[] = {kMake<ChildOrder::entry, BoxRay>, kMake<ChildOrder::entry, NaiveBoxRay>,
                                kMake<ChildOrder::entry, WilliamsBoxRay>, kMake<ChildOrder::entry, PlueckerBoxRay>};

}  // namespace

std::unique_ptr<Structure> make_bvh2_structure(Bvh bvh, const StructureInput& input, const OptionValues& options) {
  if (options.is_on("order") && options.is_on("box")) {
    throw Error(ErrorCode::invalid_option, "bvh2", "another box test goes with order=entry only");
  }
  const auto order = static_cast<size_t>(options["order"]), box = static_cast<size_t>(options["box"]);
  input.limit.check(bvh.bytes());
  return (box > 0 ? kByBoxTest[box] : kByOrder[order])(std::move(bvh), input);
}

}  // namespace kerf
