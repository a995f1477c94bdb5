#pragma once

#include <algorithm>
#include <array>

#include "kerf/build/top_down.h"
#include "kerf/scene/structure.h"

namespace kerf {

// The makers of kerf/scene/structures, a file each, and their rows for the tables in structure.cpp.

std::unique_ptr<const Structure> make_bvh2_structure(Bvh bvh, const StructureInput& input, const OptionValues& options);
inline constexpr LayoutEntry kBvh2Layout = {
    "bvh2",
    "a binary tree, the boxes of both children beside each other, one ray at a time; what a builder alone means",
    "",
    {},
    0,
    make_bvh2_structure};

std::unique_ptr<const Structure> build_brute_force(StructureInput input, const OptionValues& options);
inline constexpr StructureEntry kBruteForceStructure = {
    "brute_force", "tests every primitive, without a tree", "", {}, false, build_brute_force};

std::unique_ptr<const Structure> build_uniform_grid_structure(StructureInput input, const OptionValues& options);
inline constexpr OptionSpec kUniformGridOptions[] = {
    {"density", "cells for each primitive, about", 4, 0, 1000, false, true},
    {"cap", "references for each primitive, at most; above that the grid is made coarser", 16, 1},
    {"clip", "whether a cell gets only primitives that reach into it, not those whose box does", 1, kOffOn},
    {"mailbox", "whether a primitive in many cells is tested once for each ray", 1, kOffOn},
};
inline constexpr StructureEntry kUniformGridStructure = {
    "uniform_grid",
    "cells of equal size, about as many as primitives; slow where a small dense part stands in a large coarse scene",
    "Amanatides, Woo: A Fast Voxel Traversal Algorithm for Ray Tracing, 1987",
    kUniformGridOptions,
    false,
    build_uniform_grid_structure};

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
    build_octree_structure};

std::unique_ptr<const Structure> build_quadtree_structure(StructureInput input, const OptionValues& options);
inline constexpr StructureEntry kQuadtreeStructure = {
    "quadtree",
    "cells divided into four at their middle, along two axes",
    "Finkel, Bentley: Quad Trees, a Data Structure for Retrieval on Composite Keys, 1974",
    kQuadtreeOptions,
    false,
    build_quadtree_structure};

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
    build_bih_structure};

}  // namespace kerf
