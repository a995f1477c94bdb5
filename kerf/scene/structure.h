#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kerf/base/options.h"
#include "kerf/base/work_limit.h"
#include "kerf/references/clipper.h"
#include "kerf/trace/trace_table.h"
#include "kerf/tree/bvh.h"
#include "kerf/tree/fragments.h"
#include "kerf/tree/refit_nodes.h"

namespace kerf {

/// What a structure is made from.
struct StructureInput {
  std::span<const Geometry> geometries;  ///< outlives the structure
  std::vector<Reference> references;     ///< of whole primitives, or of pieces where a splitter came first
  bool is_split = false;                 ///< some primitive has more than one reference
  bool refittable = false;               ///< what Structure::refit() needs is to be kept
  WorkLimit limit;                       ///< checked now and then
  HeldBytes held;                        ///< of the references
};

/// One node, cell or leaf of a structure as study and tests see it.
struct NodeView {
  Box3f bounds;
  uint32_t depth = 0;
  bool is_leaf = false;
  std::span<const LeafSlot> slots;  ///< of a leaf; kRepeated is of no meaning here
};

/// What rays are traced through, of whatever kind, and what it can say of itself.
class Structure {
 public:
  virtual ~Structure() = default;

  /// Its queries and what they work on; fetched once when a scene is built.
  virtual const TraceTable& table() const = 0;
  virtual const void* data() const = 0;
  /// What its queries run on, by the name that instruction_sets() has for it.
  virtual std::string_view instruction_set() const { return "scalar"; }

  /// Of what rays are traced through, without the caller's memory.
  virtual size_t bytes() const = 0;
  /// Equal for equal structures; 0 for one that has nothing but the primitives.
  virtual uint64_t hash() const = 0;
  /// What is wrong with it, if anything: every rule that its queries rely on.
  virtual std::optional<std::string> find_fault() const = 0;
  /// Calls `visit` for every node, a parent before its children and each child's subtree at one go.
  virtual void visit_nodes(const std::function<void(const NodeView&)>& visit) const = 0;
  /// What a random ray that meets the bounds costs: by default the surface area heuristic over visit_nodes(), see
  /// sah_cost().
  virtual double cost() const;

  /// Makes every box anew around what moved. Throws Error(invalid_option) where that cannot be done; see
  /// LayoutEntry::refits.
  virtual RefitOutcome refit(const Fragments& fragments);
  /// That it keeps for refits.
  virtual size_t refit_bytes() const { return 0; }
};

/// Counted over visit_nodes().
struct StructureStatistics {
  size_t nodes = 0, leaves = 0;
  size_t references = 0;  ///< slots in leaves
  uint32_t depth = 0;
  uint32_t largest_leaf = 0;  ///< slots
  double cost = 0;            ///< Structure::cost()
};
StructureStatistics measure(const Structure& structure);

/// What visits cost, by the names of the options of builders and optimisers.
struct TreeCosts {
  double inner, leaf, primitive;
};

/// Traces a Bvh in a way of its own.
struct LayoutEntry {
  std::string_view name;
  std::string_view sentence;
  std::string_view source;
  std::span<const OptionSpec> options;
  uint32_t leaf_size;  ///< slots that a leaf of the Bvh may have at most; 0: any number
  /// The input's references are gone: they are in the Bvh.
  std::unique_ptr<Structure> (*make)(Bvh bvh, const StructureInput& input, const OptionValues& options);
  bool is_bounded = true;  ///< it never takes more than bytes_per_reference
  bool refits = false;     ///< its structures can be refitted
  /// With the Bvh that it is made from; by default a tree and its nodes once more.
  size_t bytes_per_reference = sizeof(LeafSlot) + 4 * sizeof(BvhNode);
  /// What visits cost where there are triangles only, for the leaf decisions of builders and optimisers.
  TreeCosts (*costs)(const OptionValues& options) = nullptr;
};
std::span<const LayoutEntry> layouts();

/// Makes something from references that is no Bvh.
struct StructureEntry {
  std::string_view name;
  std::string_view sentence;
  std::string_view source;
  std::span<const OptionSpec> options;
  bool takes_pieces;  ///< a splitter may stand before it
  std::unique_ptr<const Structure> (*build)(StructureInput input, const OptionValues& options);
  size_t bytes_per_reference;  ///< what it takes for each reference at least
};
std::span<const StructureEntry> structures();

}  // namespace kerf
