#include "kerf/build/optimisers.h"

namespace kerf {
namespace {

constexpr OptionSpec kReinsertionOptions[] = {
    {"iterations", "times that better places are looked for, at most", 4, 0, 1000, true},
    {"share", "of the nodes, those with the largest boxes, for which places are looked for each time", 0.3, 0, 1},
    {"leaf", "references in a leaf made of several, at most; the builder's leaves stay whole", 4, 1, 255, true},
    {"inner_cost", "cost of visiting a node, for the leaf decision", 1, 0},
    {"primitive_cost", "cost of testing a primitive, for the leaf decision", 1, 0, 1e30, false, true},
    {"leaf_cost", "cost of visiting a leaf, besides its primitives, for the leaf decision", 0, 0, 1e30},
};

constexpr OptimiserEntry kOptimisers[] = {
    {"reinsertion", "moves subtrees to where they add least to the surface area, many at a time",
     "Meister, Bittner: Parallel Reinsertion for Bounding Volume Hierarchy Optimization, 2018", kReinsertionOptions,
     optimise_reinsertion, 176},
};

}  // namespace

std::span<const OptimiserEntry> optimisers() { return kOptimisers; }

}  // namespace kerf
