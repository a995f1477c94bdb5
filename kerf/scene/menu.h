#pragma once

#include <span>
#include <string_view>
#include <variant>

#include "kerf/build/builders.h"
#include "kerf/build/optimisers.h"
#include "kerf/choose/splitters.h"
#include "kerf/scene/presets.h"
#include "kerf/scene/structure.h"

namespace kerf {

/// One word of a pipeline.
struct MenuEntry {
  std::string_view kind;  ///< "preset", "splitter", "builder", "optimiser", "layout" or "structure"
  std::string_view name;
  std::string_view sentence;  ///< what it does
  std::string_view source;    ///< the paper, empty where there is none
  std::span<const OptionSpec> options;
  std::variant<const PresetEntry*, const SplitterEntry*, const BuilderEntry*, const OptimiserEntry*, const LayoutEntry*,
               const StructureEntry*>
      entry;

  /// It works on a tree: a builder must stand before it.
  bool takes_tree() const { return kind == "optimiser" || kind == "layout"; }
};

/// Everything that a pipeline may name, in the order of the flow. What is not here does not exist.
std::span<const MenuEntry> menu();

/// Adds an entry of the caller's own, which must outlive all use of the menu: from then on it is known everywhere. To
/// be called before anything else uses the menu; spans and pipelines from before are not valid any more. Throws
/// Error(invalid_option) for a name that is taken.
void add_to_menu(const SplitterEntry& entry);
void add_to_menu(const BuilderEntry& entry);
void add_to_menu(const OptimiserEntry& entry);
void add_to_menu(const LayoutEntry& entry);
void add_to_menu(const StructureEntry& entry);

}  // namespace kerf
