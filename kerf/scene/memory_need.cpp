#include "kerf/scene/memory_need.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "kerf/choose/automatic_split.h"
#include "kerf/scene/structure.h"

namespace kerf {
namespace {

/// What the stages of a pipeline take at their peaks.
struct Takes {
  size_t per_primitive = 0, per_split_reference = 0;  ///< the splitter
  size_t per_reference = sizeof(Reference);           ///< all that comes behind it
  double growth = 1;                                  ///< references for each primitive, at most
  bool is_bounded = true;
};

bool has_option(const Stage& stage, std::string_view name) {
  const std::span<const OptionSpec> specs = stage.entry->options;
  return std::any_of(specs.begin(), specs.end(), [&](const OptionSpec& spec) { return spec.name == name; });
}

/// How many references a stage may make of each that it is given.
double growth_of(const Stage& stage) {
  if (has_option(stage, "budget") && stage.options.is_set("budget")) return stage.options["budget"];
  if (!has_option(stage, "cap")) return 1;
  const bool is_auto = has_option(stage, "sa_max") && is_automatic(stage.options["sa_max"]);
  return is_auto && !stage.options.is_set("cap") ? AutomaticSplit{}.cap : stage.options["cap"];
}

Takes takes_of(const Pipeline& pipeline) {
  Takes takes;
  for (const Stage& stage : pipeline.stages) {
    size_t bytes = layouts().front().bytes_per_reference;
    if (const auto* splitter = std::get_if<const SplitterEntry*>(&stage.entry->entry)) {
      takes.per_primitive = (*splitter)->bytes_per_primitive;
      takes.per_split_reference = (*splitter)->bytes_per_reference;
      takes.growth *= growth_of(stage);
      continue;
    }
    if (const auto* builder = std::get_if<const BuilderEntry*>(&stage.entry->entry)) {
      bytes = std::max(bytes, (*builder)->bytes_per_reference);
      takes.growth *= growth_of(stage);
    } else if (const auto* optimiser = std::get_if<const OptimiserEntry*>(&stage.entry->entry)) {
      bytes = (*optimiser)->bytes_per_reference;
    } else if (const auto* layout = std::get_if<const LayoutEntry*>(&stage.entry->entry)) {
      takes.is_bounded = takes.is_bounded && (*layout)->is_bounded;
      bytes = (*layout)->bytes_per_reference;
    } else {
      bytes = std::get<const StructureEntry*>(stage.entry->entry)->bytes_per_reference;
      takes.is_bounded = false;
    }
    takes.per_reference = std::max(takes.per_reference, bytes);
  }
  return takes;
}

}  // namespace

MemoryNeed memory_need(const Pipeline& pipeline, size_t primitives, size_t bytes) {
  const Takes takes = takes_of(pipeline);
  const size_t given = primitives * takes.per_primitive;
  const auto need = [&](size_t references, size_t per_reference) {
    return std::max(given + references * takes.per_split_reference, references * per_reference);
  };
  MemoryNeed result;
  result.least = need(primitives, takes.per_reference);
  const double most = std::min(takes.growth * static_cast<double>(primitives), static_cast<double>(kMaxReferences));
  // Where a limit leaves no room for the layout that a preset prefers, it takes the plain one.
  const size_t of_layout = pipeline.ends_with_preset ? preset_layout(0).bytes_per_reference : 0;
  result.most = takes.is_bounded ? need(static_cast<size_t>(std::ceil(most)), std::max(takes.per_reference, of_layout))
                                 : MemoryNeed::kUnbounded;
  if (bytes == MemoryNeed::kUnbounded) return result;
  result.most_references = bytes / takes.per_reference;
  if (takes.per_split_reference > 0) {
    const size_t left = bytes - std::min(bytes, given);
    result.most_references = std::min(result.most_references, left / takes.per_split_reference);
  }
  return result;
}

}  // namespace kerf
