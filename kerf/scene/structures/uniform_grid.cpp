#include "kerf/build/uniform_grid.h"

#include "kerf/scene/structures/all.h"
#include "kerf/trace/mailbox.h"
#include "kerf/trace/trace_uniform_grid.h"
#include "kerf/tree/cell_slots.h"

namespace kerf {
namespace {

template <class Seen>
class UniformGridStructure : public Structure {
 public:
  UniformGridStructure(UniformGrid grid, const StructureInput& input) : hash_(tree_hash(grid)) {
    tracer_.grid = std::move(grid);
    tracer_.geometries = input.geometries;
  }

  const TraceTable& table() const override { return uniform_grid_table(std::is_same_v<Seen, Mailbox>); }
  const void* data() const override { return &tracer_; }
  size_t bytes() const override { return tracer_.grid.bytes(); }
  uint64_t hash() const override { return hash_; }
  std::optional<std::string> find_fault() const override { return kerf::find_fault(tracer_.grid, tracer_.geometries); }

  /// The grid, below it every cell, empty ones as well.
  void visit_nodes(const std::function<void(const NodeView&)>& visit) const override {
    const UniformGrid& grid = tracer_.grid;
    if (grid.is_empty()) return;
    visit({grid.bounds(), 0, false, {}});
    for (size_t number = 0; number < grid.cell_count(); ++number) {
      visit({grid.cell_bounds(grid.cell(number)), 1, true, grid.slots_of(number)});
    }
  }

  /// A cell costs a step whether it is empty or not, and then its primitives: the sum over cells of area / area of the
  /// grid, times 1 + the number of slots. Repeats that a mailbox saves are not taken off.
  double cost() const override {
    const UniformGrid& grid = tracer_.grid;
    const double whole = half_area(grid.bounds());
    double sum = 0;
    for (size_t number = 0; number < grid.cell_count(); ++number) {
      sum += half_area(grid.cell_bounds(grid.cell(number))) * (1 + static_cast<double>(grid.slots_of(number).size()));
    }
    return whole > 0 ? sum / whole : 0;
  }

 private:
  UniformGridTracer<Seen> tracer_;
  uint64_t hash_;
};

}  // namespace

std::unique_ptr<const Structure> build_uniform_grid_structure(StructureInput input, const OptionValues& options) {
  const std::span<const Geometry> geometries = input.geometries;
  const UniformGridOptions wanted{options["density"], options["cap"], options.is_on("clip")};
  UniformGrid grid = build_uniform_grid(input.references, geometry_clipper(geometries), wanted, input.limit);
  mark_repeated(grid.slots, geometries);
  if (options.is_on("mailbox")) return std::make_unique<const UniformGridStructure<Mailbox>>(std::move(grid), input);
  return std::make_unique<const UniformGridStructure<NoMailbox>>(std::move(grid), input);
}

}  // namespace kerf
