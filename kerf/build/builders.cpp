#include "kerf/build/builders.h"

#include <algorithm>
#include <array>

#include "kerf/build/clusters.h"
#include "kerf/build/spatial_bins.h"
#include "kerf/build/top_down.h"

namespace kerf {
namespace {

/// What all top-down builders share, and a builder's own.
template <size_t kOwn>
constexpr auto with_shared(const OptionSpec (&own)[kOwn]) {
  constexpr size_t kShared = std::size(TopDownOptions::kSpecs);
  std::array<OptionSpec, kShared + kOwn> specs{};
  std::copy_n(TopDownOptions::kSpecs, kShared, specs.begin());
  std::copy_n(own, kOwn, specs.begin() + kShared);
  return specs;
}

constexpr OptionSpec kBins = {
    "bins", "slices along each axis, fewer in small nodes; the planes tried lie between them", 32, 2, 256, true};
constexpr OptionSpec kSeed = {"seed", "another number gives another tree", 1, 0, 0x1p32, true};

constexpr auto kBinnedOptions = with_shared({kBins, {"planes", "the same as bins = planes + 1", 31, 1, 255, true}});
constexpr auto kShelvesOptions = with_shared(
    {kBins, {"share", "a box with more than this share of the node's area goes on a shelf", 0.5, 0, 1, false, true}});
constexpr auto kSpatialOptions = with_shared(
    {kBins,
     {"spatial_bins", "slices of the node's box along each axis; the planes that cut lie between them", 16, 2,
      SpatialSlices::kMost, true},
     {"overlap", "cuts are tried where halves overlap by more than this share of the root's area", 1e-5, 0, 1},
     {"node_overlap", "and by more than this share of their node's area", 0, 0, 1},
     {"favour", "times the cost of the best division without cuts that one with cuts may cost", 1.1, 0.5, 2},
     {"cap", "references for each one given, on average, that are never passed", 2, 1, 64}});
constexpr auto kRandomOptions = with_shared({{"candidates", "planes tried at each node", 16, 1, 256, true}, kSeed});

constexpr std::string_view kInsertionOrders[] = {"given", "shuffled"};
constexpr std::string_view kInsertionSearches[] = {"way", "all"};
constexpr auto kInsertionOptions = with_shared(
    {{"order", "the order in which references are inserted", 1, kInsertionOrders},
     {"search", "places tried: on the way of least growth, or all that may be better", 1, kInsertionSearches},
     kSeed});

constexpr auto kPlocOptions =
    with_shared({{"radius", "how far along the curve the nearest is looked for", 16, 1, Clusters::kMostRadius, true}});

constexpr BuilderEntry kBuilders[] = {
    {"binned_sah", "the cheapest of a few planes by the surface area heuristic",
     "Wald: On fast Construction of SAH-based Bounding Volume Hierarchies, 2007", kBinnedOptions, build_binned_sah},
    {"sweep_sah", "the cheapest of all planes by the surface area heuristic, sorted once",
     "Wald, Boulos, Shirley: Ray Tracing Deformable Scenes using Dynamic Bounding Volume Hierarchies, 2007",
     TopDownOptions::kSpecs, build_sweep_sah, 160},  // its sorted lines are there until the parts are made
    {"spatial_split", "binned_sah, but where halves would overlap large references may be cut",
     "Stich, Friedrich, Dietrich: Spatial Splits in Bounding Volume Hierarchies, 2009", kSpatialOptions,
     build_spatial_split, kSpatialSplitBytes},
    {"spatial_median", "the plane through the centre of the node's box, across its longest side",
     "Kay, Kajiya: Ray Tracing Complex Scenes, 1986", TopDownOptions::kSpecs, build_spatial_median},
    {"object_median", "equal counts along the axis where the centres spread most",
     "Kay, Kajiya: Ray Tracing Complex Scenes, 1986", TopDownOptions::kSpecs, build_object_median},
    {"random_top_down", "the cheapest of some random planes by the surface area heuristic",
     "Ng, Trifonov: Automatic Bounding Volume Hierarchy Generation Using Stochastic Search Methods, 2003",
     kRandomOptions, build_random_top_down},
    {"oversize_shelves", "binned_sah, but references nearly as large as their node stay there in leaves of their own",
     "Havran, Herzog, Seidel: On the Fast Construction of Spatial Hierarchies for Ray Tracing, 2006", kShelvesOptions,
     build_oversize_shelves, 144},
    {"insertion", "one reference after another, each where it adds least to the cost",
     "Goldsmith, Salmon: Automatic Creation of Object Hierarchies for Ray Tracing, 1987 (search=way)",
     kInsertionOptions, build_insertion, 160},
    {"lbvh", "cut where the highest bit of a space-filling curve changes: the fastest to build",
     "Lauterbach et al.: Fast BVH Construction on GPUs, 2009; Karras: Maximizing Parallelism in the Construction of "
     "BVHs, Octrees, and k-d Trees, 2012",
     TopDownOptions::kSpecs, build_lbvh},
    {"ploc", "joins those that are each other's nearest along a space-filling curve, until one is left",
     "Meister, Bittner: Parallel Locally-Ordered Clustering for Bounding Volume Hierarchy Construction, 2018",
     kPlocOptions, build_ploc},
};

}  // namespace

std::span<const BuilderEntry> builders() { return kBuilders; }

}  // namespace kerf
