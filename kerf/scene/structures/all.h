#pragma once

#include <algorithm>
#include <array>

#include "kerf/build/bsp_sah.h"
#include "kerf/build/top_down.h"
#include "kerf/layout/quantised_bvh.h"
#include "kerf/layout/wide_bvh.h"
#include "kerf/layout/wide_collapse.h"
#include "kerf/scene/structure.h"

namespace kerf {

// The makers of kerf/scene/structures, a file each, and their rows for the tables in structure.cpp.

std::unique_ptr<Structure> make_bvh2_structure(Bvh bvh, const StructureInput& input, const OptionValues& options);
inline constexpr std::string_view kBvh2Orders[] = {"entry", "fixed", "axis", "heap"};
inline constexpr std::string_view kBvh2BoxTests[] = {"ours", "naive", "williams", "pluecker"};
inline constexpr OptionSpec kBvh2Options[] = {
    {"order", "which child first: by entry distance, as stored, by axis and sign, of all that wait the nearest", 0,
     kBvh2Orders},
    {"box", "the box test: Kerf's, or one of the literature, to compare", 0, kBvh2BoxTests},
};
inline constexpr LayoutEntry kBvh2Layout = {
    "bvh2",
    "a binary tree, the boxes of both children beside each other, one ray at a time; what a builder alone means",
    "",
    kBvh2Options,
    0,
    make_bvh2_structure,
    true,
    true};

std::unique_ptr<Structure> make_skip_pointer_structure(Bvh bvh, const StructureInput& input,
                                                       const OptionValues& options);
inline constexpr LayoutEntry kSkipPointerLayout = {
    "skip_pointer",
    "a binary tree in depth-first order, each node with a pointer to the one after its subtree: no stack",
    "Smits: Efficiency Issues for Ray Tracing, 1998",
    {},
    0,
    make_skip_pointer_structure,
    true,
    true};

std::unique_ptr<Structure> make_packets_structure(Bvh bvh, const StructureInput& input, const OptionValues& options);
inline constexpr std::string_view kPacketSizes[] = {"4", "8", "16"};
inline constexpr OptionSpec kPacketOptions[] = {{"size", "rays in a packet", 1, kPacketSizes}};
inline constexpr LayoutEntry kPacketsLayout = {
    "packets",
    "bvh2, but the rays of a batch go in packets of consecutive ones; single rays as in bvh2",
    "Wald, Boulos, Shirley: Ray Tracing Deformable Scenes using Dynamic Bounding Volume Hierarchies, 2007",
    kPacketOptions,
    0,
    make_packets_structure,
    true,
    true};

std::unique_ptr<Structure> make_bvh4_structure(Bvh bvh, const StructureInput& input, const OptionValues& options);
std::unique_ptr<Structure> make_bvh8_structure(Bvh bvh, const StructureInput& input, const OptionValues& options);
inline constexpr OptionSpec kWideOptions[] = {
    {"leaf_cost", "cost of visiting a leaf, against that of a node, for the collapse", WideCosts{}.leaf, 0, 1e30},
    {"triangle_cost", "cost of each of its triangles, against that of a node", WideCosts{}.triangle, 0, 1e30},
};
/// A Bvh and what its collapse holds, then at worst a leaf for each reference, and above them nodes of two children.
template <uint32_t kWidth>
inline constexpr size_t kWideBytes = sizeof(LeafSlot) + 2 * (sizeof(BvhNode) + WideCollapse::kBytesPerNode) +
                                     TriangleLeaf::units(1) * sizeof(LeafUnit) + sizeof(WideNode<kWidth>);
inline constexpr std::string_view kWideSource =
    "Ylitie, Karras, Laine: Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs, 2017, section 3.1";
/// Where two leaves are dearer than one so are they in a wide tree, and a binary one that is not needlessly fine is
/// built and changed faster. What inner nodes cost only the collapse knows.
inline TreeCosts wide_tree_costs(const OptionValues& options) {
  return {0, options["leaf_cost"], std::max(options["triangle_cost"], 1e-6)};
}
inline constexpr LayoutEntry kBvh4Layout = {
    "bvh4",
    "nodes of up to four children, tested at once, and leaves of up to eight triangles, tested four at once",
    kWideSource,
    kWideOptions,
    TriangleLeaf::kMost,
    make_bvh4_structure,
    true,
    true,
    kWideBytes<4>,
    wide_tree_costs};
inline constexpr LayoutEntry kBvh8Layout = {
    "bvh8",
    "nodes of up to eight children, tested at once, and leaves of up to eight triangles, tested at once",
    kWideSource,
    kWideOptions,
    TriangleLeaf::kMost,
    make_bvh8_structure,
    true,
    true,
    kWideBytes<8>,
    wide_tree_costs};

std::unique_ptr<Structure> make_quantised_bvh8_structure(Bvh bvh, const StructureInput& input,
                                                         const OptionValues& options);
/// As kWideBytes, a leaf of one triangle being the largest.
inline constexpr size_t kQuantisedBytes = sizeof(LeafSlot) + 2 * (sizeof(BvhNode) + WideCollapse::kBytesPerNode) +
                                          QuantisedLeaf::units(1, 3, true) * sizeof(LeafUnit) + sizeof(QuantisedNode);
inline constexpr LayoutEntry kQuantisedBvh8Layout = {
    "quantised_bvh8",
    "bvh8 in about half the memory: boxes in ten bits a side, and the triangles of a leaf share their corners",
    "Ylitie, Karras, Laine: Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs, 2017",
    kWideOptions,
    QuantisedLeaf::kMost,
    make_quantised_bvh8_structure,
    true,
    true,
    kQuantisedBytes,
    wide_tree_costs};

std::unique_ptr<Structure> make_late_split_structure(Bvh bvh, const StructureInput& input, const OptionValues& options);
inline constexpr OptionSpec kLateSplitOptions[] = {
    {"sa_max", "surface area above which a leaf is cut, all six faces, squared scene units", Box3f::kInfinity, 0,
     Box3f::kInfinity, false, true},
    {"cap", "pieces per leaf of the builder's tree, on average, that are never passed", 16, 1, 1000},
    {"budget", "instead of sa_max: as finely as this many pieces per leaf allow", 1.5, 1, 1000},
    {"restore", "whether the rest of a cut leaf is left out once its primitive was tested", 1, kOffOn},
};
inline constexpr LayoutEntry kLateSplitLayout = {
    "late_split",
    "cuts the leaves of a finished tree, one primitive each, into trees of tight boxes",
    "Ernst, Greiner: Early Split Clipping for Bounding Volume Hierarchies, 2007, section 5.1",
    kLateSplitOptions,
    1,
    make_late_split_structure,
    false};

std::unique_ptr<const Structure> build_brute_force(StructureInput input, const OptionValues& options);
inline constexpr StructureEntry kBruteForceStructure = {
    "brute_force", "tests every primitive, without a tree", "", {}, false, build_brute_force, 104};

std::unique_ptr<const Structure> build_bsp_structure(StructureInput input, const OptionValues& options);
inline constexpr StructureEntry kBspStructure = {
    "bsp_sah",
    "a space partition by planes of faces and across axes, the cheapest by the surface areas of its convex cells",
    "Ize, Wald, Parker: Ray Tracing with the BSP Tree, 2008",
    BspOptions::kSpecs,
    false,
    build_bsp_structure,
    160};
std::unique_ptr<const Structure> build_uniform_grid_structure(StructureInput input, const OptionValues& options);
inline constexpr OptionSpec kUniformGridOptions[] = {
    {"density", "cells for each primitive, about", 4, 0, 1000, false, true},
    {"cap", "references for each primitive, at most; above that the grid is made coarser", 16, 1},
    {"clip", "whether a cell gets only primitives that reach into it, not those whose box does", 1, kOffOn},
    {"mailbox", "whether a primitive in many cells is tested once for each ray", 1, kOffOn},
};
inline constexpr StructureEntry kUniformGridStructure = {
    "uniform_grid",
    "cells of equal size, in proportion to the primitives; slow where a small dense part stands in a large coarse "
    "scene",
    "Amanatides, Woo: A Fast Voxel Traversal Algorithm for Ray Tracing, 1987",
    kUniformGridOptions,
    false,
    build_uniform_grid_structure,
    56};

inline constexpr std::string_view kRootCells[] = {"box", "cube"};
inline constexpr std::string_view kUndividedAxes[] = {"x", "y", "z", "shortest"};
inline constexpr OptionSpec kQuadtreeOptions[] = {
    {"leaf", "references above which a cell is divided", 8, 1, 255, true},
    {"depth", "depth of the tree, at most", 16, 1, kMaxDepth, true},
    {"cap", "references for each primitive, at most; each cell has its share by what it holds", 16, 1},
    {"root", "the cell that is divided: the scene's box, or a cube around it", 0, kRootCells},
    {"mailbox", "whether a primitive in many cells is tested once for each ray", 1, kOffOn},
    {"axis", "the axis that is not divided", 3, kUndividedAxes},
};

std::unique_ptr<const Structure> build_octree_structure(StructureInput input, const OptionValues& options);
inline constexpr StructureEntry kOctreeStructure = {
    "octree",
    "cells divided into eight at their middle",
    "Glassner: Space Subdivision for Fast Ray Tracing, 1984",
    std::span(kQuadtreeOptions).first<std::size(kQuadtreeOptions) - 1>(),
    false,
    build_octree_structure,
    128};

std::unique_ptr<const Structure> build_quadtree_structure(StructureInput input, const OptionValues& options);
inline constexpr StructureEntry kQuadtreeStructure = {
    "quadtree",
    "cells divided into four at their middle, along two axes",
    "Finkel, Bentley: Quad Trees, a Data Structure for Retrieval on Composite Keys, 1974",
    kQuadtreeOptions,
    false,
    build_quadtree_structure,
    128};

std::unique_ptr<const Structure> build_bih_structure(StructureInput input, const OptionValues& options);
inline constexpr auto kBihOptions = [] {
  constexpr size_t kShared = std::size(TopDownOptions::kSpecs);
  std::array<OptionSpec, kShared + 1> specs{};
  std::copy_n(TopDownOptions::kSpecs, kShared, specs.begin());
  specs[kShared] = {"cut_off", "share of its area left for children below which a node cuts off empty space; 0: never",
                    0.8, 0, 1};
  return specs;
}();
inline constexpr StructureEntry kBihStructure = {
    "bih",
    "a bounding interval hierarchy: planes where two children end along one axis, at the middles of a regular grid",
    "Waechter, Keller: Instant Ray Tracing: The Bounding Interval Hierarchy, 2006",
    kBihOptions,
    true,
    build_bih_structure,
    136};
std::unique_ptr<const Structure> build_kd_sah(StructureInput input, const OptionValues& options);
inline constexpr std::string_view kKdBuilds[] = {"exact", "sampled"};
inline constexpr OptionSpec kKdOptions[] = {
    {"build", "planes at every side of a box, or at samples of their positions", 0, kKdBuilds},
    {"samples", "with build=sampled: positions along an axis in each of two passes", 16, 1, 64, true},
    {"clip", "whether primitives are cut at planes; else their boxes are", 1, kOffOn},
    {"empty_bonus", "share of its cost that a plane is let off for cutting off empty space", 0.1, 0, 1},
    {"traversal_cost", "cost of visiting a node", 1, 0, 1e30},
    {"primitive_cost", "cost of testing a primitive", 1, 0, 1e30, false, true},
    {"leaf", "cells of so many references are not divided further", 1, 1, 255, true},
    {"depth", "depth of the tree, at most; 0: 8 + 1.3 log2 of the number of primitives", 0, 0, kMaxDepth, true},
    {"trial", "whether a cell that no plane improves is halved, and stays so if its subtree pays", 1, kOffOn},
    {"cap", "references for each primitive, at most", 32, 1},
    {"mailbox", "whether a ray remembers the last primitives it tested", 0, kOffOn},
};
inline constexpr StructureEntry kKdSahStructure = {
    "kd_sah",
    "a kd-tree by the surface area heuristic with split clipping",
    "Havran and Bittner 2002; Wald and Havran 2006; Hunt, Mark, Stoll 2006",
    kKdOptions,
    false,
    build_kd_sah,
    160};

}  // namespace kerf
