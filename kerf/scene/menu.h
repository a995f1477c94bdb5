#pragma once

#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include "kerf/build/builders.h"
#include "kerf/references/splitters.h"
#include "kerf/trace/trace_table.h"

namespace kerf {

/// A structure that traces the references as they are, without a tree.
struct PlainEntry {
  std::string_view name;
  std::string_view sentence;
  std::string_view source;
  std::span<const OptionSpec> options;
};

/// One word of a pipeline.
struct MenuEntry {
  std::string_view kind;  ///< "splitter", "builder" or "structure"
  std::string_view name;
  std::string_view sentence;  ///< what it does
  std::string_view source;    ///< the paper, empty where there is none
  std::span<const OptionSpec> options;
  std::variant<const SplitterEntry*, const BuilderEntry*, const PlainEntry*> entry;
};

/// Everything that a pipeline may name, in the order of the flow. What is not here does not exist.
std::span<const MenuEntry> menu();

}  // namespace kerf
