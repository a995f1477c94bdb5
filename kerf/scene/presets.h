#pragma once

#include <span>
#include <string_view>

#include "kerf/scene/structure.h"

namespace kerf {

/// A name that stands for a whole pipeline but for the layout, which may follow it; else preset_layout() is.
struct PresetEntry {
  std::string_view name;
  std::string_view sentence;
  std::string_view pipeline;
};

/// From the fastest to build to the fastest to trace rays through; docs/splitting.md has what they were chosen by.
std::span<const PresetEntry> presets();

/// The layout of a preset's tree of so many references, where no other is asked for: bvh8, and above kManyReferences, a
/// gigabyte of it, quantised_bvh8, which takes about half the memory.
const LayoutEntry& preset_layout(size_t references);
inline constexpr size_t kManyReferences = size_t{1} << 24;

/// What a scene is built with unless something else is asked for.
inline constexpr std::string_view kDefaultStructure = "balanced";

}  // namespace kerf
