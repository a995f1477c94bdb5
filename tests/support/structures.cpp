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

std::vector<std::string> pipelines(bool with_all_split) {
  std::vector<std::string> all;
  const std::string early = "early_split(budget=2)+";
  for (const MenuEntry& entry : menu()) {
    const std::string name(entry.name);
    if (entry.kind == "splitter") all.push_back(splitting_text(name) + "+binned_sah");
    if (entry.kind == "builder" || entry.kind == "structure") all.push_back(name);
    if (entry.kind == "layout") all.push_back("binned_sah+" + splitting_text(name));
    const auto* structure = std::get_if<const StructureEntry*>(&entry.entry);
    if (structure != nullptr && (*structure)->takes_pieces) all.push_back(early + name);
    if (with_all_split && entry.kind == "builder") all.push_back(early + name);
    if (with_all_split && entry.kind == "layout") all.push_back(early + "binned_sah+" + splitting_text(name));
  }
  return all;
}

}  // namespace

std::vector<std::string> traceable_pipelines() { return pipelines(false); }
std::vector<std::string> all_pipelines() { return pipelines(true); }

std::string test_name(const std::string& pipeline) {
  std::string name = pipeline;
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  }
  return name;
}

}  // namespace kerf::test
