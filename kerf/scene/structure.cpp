#include "kerf/scene/structure.h"

#include <algorithm>

#include "kerf/base/error.h"
#include "kerf/scene/structures/all.h"

namespace kerf {

double Structure::cost() const {
  double root = 0, sum = 0;
  LimitWatch watch;
  visit_nodes([&](const NodeView& node) {
    watch.step();
    const double area = half_area(node.bounds);
    if (node.depth == 0) root = area;
    sum += area * (node.is_leaf ? static_cast<double>(node.slots.size()) : 1);
  });
  return root > 0 ? sum / root : 0;
}

RefitOutcome Structure::refit(const Fragments&) {
  throw Error(ErrorCode::invalid_option, "structure", "it cannot be refitted; build it anew");
}

StructureStatistics measure(const Structure& structure) {
  StructureStatistics statistics;
  LimitWatch watch;
  structure.visit_nodes([&](const NodeView& node) {
    watch.step();
    ++statistics.nodes;
    statistics.depth = std::max(statistics.depth, node.depth);
    if (!node.is_leaf) return;
    ++statistics.leaves;
    statistics.references += node.slots.size();
    statistics.largest_leaf = std::max(statistics.largest_leaf, static_cast<uint32_t>(node.slots.size()));
  });
  statistics.cost = structure.cost();
  return statistics;
}

namespace {

constexpr LayoutEntry kLayouts[] = {kBvh2Layout,        kBvh4Layout,    kBvh8Layout,     kQuantisedBvh8Layout,
                                    kSkipPointerLayout, kPacketsLayout, kLateSplitLayout};
constexpr StructureEntry kStructures[] = {kKdSahStructure, kBihStructure,      kUniformGridStructure, kOctreeStructure,
                                          kBspStructure,   kQuadtreeStructure, kBruteForceStructure};

}  // namespace

std::span<const LayoutEntry> layouts() { return kLayouts; }
std::span<const StructureEntry> structures() { return kStructures; }

}  // namespace kerf
