#pragma once

#include <span>
#include <string_view>

#include "kerf/base/options.h"
#include "kerf/base/work_limit.h"
#include "kerf/references/clipper.h"
#include "kerf/references/split_result.h"

namespace kerf {

/// What a splitter works on: references of whole primitives.
struct SplitInput {
  std::span<const Geometry> geometries;
  std::span<const Reference> whole;
  Clipper clipper;
  WorkLimit limit;
};

/// One splitter of the menu: references in, more references out.
struct SplitterEntry {
  std::string_view name;
  std::string_view sentence;
  std::string_view source;
  std::span<const OptionSpec> options;
  SplitResult (*split)(const SplitInput& input, const OptionValues& options);
};

std::span<const SplitterEntry> splitters();

}  // namespace kerf
