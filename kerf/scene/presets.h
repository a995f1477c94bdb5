#pragma once

#include <span>
#include <string_view>

namespace kerf {

/// A name that stands for a whole pipeline but for the layout, which may follow it.
struct PresetEntry {
  std::string_view name;
  std::string_view sentence;
  std::string_view pipeline;
};

/// From the fastest to build to the fastest to trace rays through; docs/splitting.md has what they were chosen by.
std::span<const PresetEntry> presets();

/// What a scene is built with unless something else is asked for.
inline constexpr std::string_view kDefaultStructure = "balanced";

}  // namespace kerf
