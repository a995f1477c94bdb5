#pragma once

#include <cstdint>
#include <string_view>

namespace kerf {

/// The keywords of an MTL: those that have an effect, other textures, and what else is known.
enum class MtlKeyword : uint8_t {
  newmtl,
  diffuse,
  specular,
  emission,
  shininess,
  refractive_index,
  dissolve,
  transparency,
  illumination,
  roughness,
  metallic,
  albedo_map,
  other_map,
  passed_over
};

/// The keyword, in any case of letters. Throws ObjFault with the nearest right one for a word that is none.
MtlKeyword find_mtl_keyword(std::string_view word);

/// What may stand before the name of a texture's file, and how many words follow it; where that varies they are
/// numbers.
struct MtlMapOption {
  std::string_view word;
  int least, most;
};

/// As find_mtl_keyword().
const MtlMapOption& find_mtl_map_option(std::string_view word);

}  // namespace kerf
