#pragma once

#include <span>
#include <string_view>

#include "kerf/base/options.h"
#include "kerf/references/early_split.h"

namespace kerf {

/// One splitter of the menu: references in, more references out.
struct SplitterEntry {
  std::string_view name;
  std::string_view sentence;
  std::string_view source;
  std::span<const OptionSpec> options;
  EarlySplitResult (*split)(std::span<const Reference> whole, const Clipper& clipper, const OptionValues& options);
};

std::span<const SplitterEntry> splitters();

}  // namespace kerf
