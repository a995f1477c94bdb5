#pragma once

#include <span>
#include <string>
#include <vector>

#include "kerf/io/material.h"

namespace kerf {

/// A material of an MTL file, its texture not yet loaded.
struct MtlMaterial {
  Material material;
  std::string albedo_map;     ///< the file that map_Kd names, as it is written; empty: none
  bool is_map_alone = false;  ///< no Kd stands beside the map, or a black one: the albedo is white where the map is had
};

/// The content of an MTL file.
struct MtlLibrary {
  std::vector<MtlMaterial> materials;  ///< each name once
  std::vector<std::string> notes;      ///< what cannot be shown, one of each kind
};

/// Reads a Wavefront MTL file, with the extension for physically based materials (Pr, Pm), out of memory.
///
/// Kd is the albedo, Ke the emission. illum 4, 6, 7 and 9 make glass of index Ni, 3 and 5 a metal of colour Ks (of
/// colour Kd where Ks is black or a map_Kd or Pm stands beside), Pm above 0 a metal of colour Kd; what else has d below
/// 1 or Tr above 0 lets that much light through, straight on unless Ni says otherwise. Where both stand, d counts; Tr 1
/// alone is opaque, as some programs write it in the opposite sense. A metal's roughness is Pr, or comes from Ns.
/// Colours and shares above 1 are taken as 1. The first of two materials of one name counts. Keywords may be of any
/// case. What is known and has no effect here is passed over; textures other than map_Kd, and the options of that, with
/// a note.
///
/// Throws Error (file) with the place "NAME:LINE": an unknown keyword or option (with the nearest right word), a number
/// that is none, is negative, not finite or missing, a statement before the first newmtl.
MtlLibrary parse_mtl(std::span<const char> bytes, const std::string& name);

}  // namespace kerf
