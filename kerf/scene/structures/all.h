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
    build_kd_sah};

}  // namespace kerf
