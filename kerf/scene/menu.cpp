#include "kerf/scene/menu.h"

#include <algorithm>
#include <string>
#include <vector>

#include "kerf/base/error.h"

namespace kerf {
namespace {

template <class Entry>
MenuEntry make_entry(std::string_view kind, const Entry& entry) {
  return {kind, entry.name, entry.sentence, entry.source, entry.options, &entry};
}

std::vector<MenuEntry> joined() {
  std::vector<MenuEntry> all;
  for (const PresetEntry& entry : presets()) {
    all.push_back({"preset", entry.name, entry.sentence, entry.pipeline, {}, &entry});
  }
  for (const SplitterEntry& entry : splitters()) all.push_back(make_entry("splitter", entry));
  for (const BuilderEntry& entry : builders()) all.push_back(make_entry("builder", entry));
  for (const OptimiserEntry& entry : optimisers()) all.push_back(make_entry("optimiser", entry));
  for (const LayoutEntry& entry : layouts()) all.push_back(make_entry("layout", entry));
  for (const StructureEntry& entry : structures()) all.push_back(make_entry("structure", entry));
  return all;
}

std::vector<MenuEntry>& entries() {
  static std::vector<MenuEntry> all = joined();
  return all;
}

/// Behind the last of its kind.
void add(const MenuEntry& added) {
  std::vector<MenuEntry>& all = entries();
  for (const MenuEntry& entry : all) {
    if (entry.name == added.name) {
      throw Error(ErrorCode::invalid_option, "menu", "the name " + std::string(added.name) + " is taken");
    }
  }
  const auto last = std::find_if(all.rbegin(), all.rend(), [&](const MenuEntry& e) { return e.kind == added.kind; });
  all.insert(last.base(), added);
}

}  // namespace

std::span<const MenuEntry> menu() { return entries(); }

void add_to_menu(const SplitterEntry& entry) { add(make_entry("splitter", entry)); }
void add_to_menu(const BuilderEntry& entry) { add(make_entry("builder", entry)); }
void add_to_menu(const OptimiserEntry& entry) { add(make_entry("optimiser", entry)); }
void add_to_menu(const LayoutEntry& entry) { add(make_entry("layout", entry)); }
void add_to_menu(const StructureEntry& entry) { add(make_entry("structure", entry)); }

}  // namespace kerf
