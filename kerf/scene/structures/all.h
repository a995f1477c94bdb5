#pragma once

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

}  // namespace kerf
