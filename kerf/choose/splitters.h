#pragma once

#include <algorithm>
#include <span>
#include <string_view>

#include "kerf/base/options.h"
#include "kerf/base/work_limit.h"
#include "kerf/references/clipper.h"
#include "kerf/references/split_each.h"
#include "kerf/references/split_result.h"

namespace kerf {

/// What a splitter works on: references of whole primitives.
struct SplitInput {
  std::span<const Geometry> geometries;
  std::span<const Reference> whole;
  Clipper clipper;
  WorkLimit limit;
  size_t most = kMaxReferences;  ///< references, whatever the options say

  /// The cap on references per primitive that keeps both `wanted` and `most`.
  double cap(double wanted) const {
    return whole.empty() ? wanted : std::min(wanted, static_cast<double>(most) / static_cast<double>(whole.size()));
  }
  /// Whether `most` leaves less room than that many references per primitive.
  bool has_less_than(double wanted) const { return most < most_references(whole.size(), wanted); }
};

/// One splitter of the menu: references in, more references out.
struct SplitterEntry {
  std::string_view name;
  std::string_view sentence;
  std::string_view source;
  std::span<const OptionSpec> options;
  SplitResult (*split)(const SplitInput& input, const OptionValues& options);
  /// What it takes at its peak, at most: for each primitive, and for each reference that it may make.
  size_t bytes_per_primitive, bytes_per_reference;
};

std::span<const SplitterEntry> splitters();

}  // namespace kerf
