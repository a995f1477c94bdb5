#include "tests/support/structures.h"

#include <cctype>

#include "kerf/scene/menu.h"

namespace kerf::test {
namespace {

/// An entry with options that make it split what tests have; whatever splits needs a row.
std::string splitting_text(std::string_view name) {
  if (name == "early_split" || name == "late_split" || name == "refine") return std::string(name) + "(budget=2)";
  return std::string(name);
}

/// An entry once for each word of each of its options but the default, which the bare name stands for.
std::vector<std::string> variants(const MenuEntry& entry) {
  std::vector<std::string> all;
  for (const OptionSpec& option : entry.options) {
    for (size_t word = 0; word < option.words.size(); ++word) {
      if (static_cast<double>(word) == option.fallback) continue;
      std::string text = splitting_text(entry.name);
      if (text.ends_with(')')) text.back() = ',';
      if (!text.ends_with(',')) text += '(';
      all.push_back(text + std::string(option.name) + "=" + std::string(option.words[word]) + ")");
    }
  }
  return all;
}

enum class Extent { menu, variants, all };

std::vector<std::string> pipelines(Extent extent) {
  std::vector<std::string> all;
  const std::string early = "early_split(budget=2)+";
  for (const MenuEntry& entry : menu()) {
    const std::string name(entry.name);
    const bool is_structure = entry.kind == "builder" || entry.kind == "structure";
    const std::string before = entry.takes_tree() ? "binned_sah+" : "";
    if (entry.kind == "splitter") all.push_back(splitting_text(name) + "+binned_sah");
    if (is_structure || entry.kind == "preset") all.push_back(name);
    if (entry.takes_tree()) all.push_back(before + splitting_text(name));
    if (extent == Extent::menu || entry.kind == "splitter" || entry.kind == "preset") continue;
    for (const std::string& variant : variants(entry)) all.push_back(before + variant);
    const auto* structure = std::get_if<const StructureEntry*>(&entry.entry);
    if (structure != nullptr && (*structure)->takes_pieces) all.push_back(early + name);
    if (extent == Extent::variants || structure != nullptr) continue;
    all.push_back(early + before + (entry.takes_tree() ? splitting_text(name) : name));
  }
  return all;
}

}  // namespace

std::vector<std::string> menu_pipelines() { return pipelines(Extent::menu); }
std::vector<std::string> traceable_pipelines() { return pipelines(Extent::variants); }
std::vector<std::string> all_pipelines() { return pipelines(Extent::all); }

std::string test_name(const std::string& pipeline) {
  std::string name = pipeline;
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  }
  return name;
}

}  // namespace kerf::test
