#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "kerf/scene/menu.h"

namespace kerf {

/// One stage of a pipeline with its options. Valid until something is added to the menu.
struct Stage {
  const MenuEntry* entry = nullptr;
  OptionValues options;
};

/// What is done to make a structure, in the order of the flow: perhaps a splitter, then a builder, perhaps
/// optimisers and perhaps a layout, or a structure.
struct Pipeline {
  std::vector<Stage> stages;
  /// It ends with a preset, which leaves the layout to be chosen for the scene: see preset_layout().
  bool ends_with_preset = false;

  /// In one canonical spelling that parse_pipeline() reads back.
  std::string text() const;
};

/// Reads "early_split(sa_max=10)+binned_sah(bins=32)". Throws Error(invalid_option) whose place names the column and
/// whose sentence has the nearest right word.
Pipeline parse_pipeline(std::string_view text);

/// Cuts a list of pipelines at the commas outside parentheses. Throws Error(invalid_option) for an empty member.
std::vector<std::string> split_pipeline_list(std::string_view text);

}  // namespace kerf
