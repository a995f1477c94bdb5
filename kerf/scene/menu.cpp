#include "kerf/scene/menu.h"

namespace kerf {
namespace {

constexpr PlainEntry kBruteForce = {"brute_force", "tests every primitive, without a tree", "", {}};

template <class Entry>
MenuEntry make_entry(std::string_view kind, const Entry& entry) {
  return {kind, entry.name, entry.sentence, entry.source, entry.options, &entry};
}

std::vector<MenuEntry> joined() {
  std::vector<MenuEntry> all;
  for (const SplitterEntry& entry : splitters()) all.push_back(make_entry("splitter", entry));
  for (const BuilderEntry& entry : builders()) all.push_back(make_entry("builder", entry));
  all.push_back(make_entry("structure", kBruteForce));
  return all;
}

}  // namespace

std::span<const MenuEntry> menu() {
  static const std::vector<MenuEntry> all = joined();
  return all;
}

}  // namespace kerf
