#include "kerf/scene/presets.h"

#include <algorithm>
#include <cassert>

namespace kerf {
namespace {

constexpr PresetEntry kPresets[] = {
    {"fast", "build time first: for what is built anew for every picture", "ploc(radius=8)"},
    {"balanced", "rays nearly as fast as with best, for a fraction of its build time: the default",
     "early_split(sa_max=auto)+binned_sah+reinsertion(iterations=3,share=0.1)"},
    {"best", "ray time first, whatever the build takes, and up to four times the references",
     "early_split(sa_max=auto)+spatial_split(overlap=1e-04,node_overlap=0.1)+reinsertion(iterations=2,share=0.1,leaf="
     "8)"},
};

}  // namespace

std::span<const PresetEntry> presets() { return kPresets; }

const LayoutEntry& preset_layout(size_t references) {
  const std::string_view name = references > kManyReferences ? "quantised_bvh8" : "bvh8";
  const std::span<const LayoutEntry> all = layouts();
  const auto found = std::find_if(all.begin(), all.end(), [&](const LayoutEntry& entry) { return entry.name == name; });
  assert(found != all.end());
  return *found;
}

}  // namespace kerf
