#include "kerf/build/builders.h"

#include <algorithm>
#include <array>

#include "kerf/build/top_down.h"

namespace kerf {
namespace {

constexpr auto kBinnedOptions = [] {
  constexpr size_t kShared = std::size(TopDownOptions::kSpecs);
  std::array<OptionSpec, kShared + 2> specs{};
  std::copy_n(TopDownOptions::kSpecs, kShared, specs.begin());
  specs[kShared] = {"bins", "slices along each axis; the planes tried lie between them", 32, 2, 256, true};
  specs[kShared + 1] = {"planes", "the same as bins = planes + 1", 31, 1, 255, true};
  return specs;
}();

constexpr BuilderEntry kBuilders[] = {
    {"binned_sah", "the cheapest of a few planes by the surface area heuristic",
     "Wald: On fast Construction of SAH-based Bounding Volume Hierarchies, 2007", kBinnedOptions, build_binned_sah},
    {"sweep_sah", "the cheapest of all planes by the surface area heuristic, sorted once",
     "Wald, Boulos, Shirley: Ray Tracing Deformable Scenes using Dynamic Bounding Volume Hierarchies, 2007",
     TopDownOptions::kSpecs, build_sweep_sah},
    {"spatial_median", "the plane through the centre of the node's box, across its longest side",
     "Kay, Kajiya: Ray Tracing Complex Scenes, 1986", TopDownOptions::kSpecs, build_spatial_median},
    {"object_median", "equal counts along the axis where the centres spread most",
     "Kay, Kajiya: Ray Tracing Complex Scenes, 1986", TopDownOptions::kSpecs, build_object_median},
};

}  // namespace

std::span<const BuilderEntry> builders() { return kBuilders; }

}  // namespace kerf
