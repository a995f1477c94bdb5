#pragma once

#include "kerf/scene/structure.h"

namespace kerf {

// The makers of kerf/scene/structures, a file each, and their rows for the tables in structure.cpp.

std::unique_ptr<const Structure> make_bvh2_structure(Bvh bvh, const StructureInput& input, const OptionValues& options);
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
    make_bvh2_structure};

std::unique_ptr<const Structure> make_skip_pointer_structure(Bvh bvh, const StructureInput& input,
                                                             const OptionValues& options);
inline constexpr LayoutEntry kSkipPointerLayout = {
    "skip_pointer",
    "a binary tree in depth-first order, each node with a pointer to the one after its subtree: no stack",
    "Smits: Efficiency Issues for Ray Tracing, 1998",
    {},
    0,
    make_skip_pointer_structure};

std::unique_ptr<const Structure> make_packets_structure(Bvh bvh, const StructureInput& input,
                                                        const OptionValues& options);
inline constexpr std::string_view kPacketSizes[] = {"4", "8", "16"};
inline constexpr OptionSpec kPacketOptions[] = {{"size", "rays in a packet", 1, kPacketSizes}};
inline constexpr LayoutEntry kPacketsLayout = {
    "packets",
    "bvh2, but the rays of a batch go in packets of consecutive ones; single rays as in bvh2",
    "Wald, Boulos, Shirley: Ray Tracing Deformable Scenes using Dynamic Bounding Volume Hierarchies, 2007",
    kPacketOptions,
    0,
    make_packets_structure};

std::unique_ptr<const Structure> build_brute_force(StructureInput input, const OptionValues& options);
inline constexpr StructureEntry kBruteForceStructure = {
    "brute_force", "tests every primitive, without a tree", "", {}, false, build_brute_force};

}  // namespace kerf
