#include "kerf/scene/presets.h"

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

}  // namespace kerf
