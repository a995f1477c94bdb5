#include "kerf/io/obj/mtl_keywords.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "kerf/base/letter_case.h"
#include "kerf/base/nearest_word.h"
#include "kerf/io/message.h"
#include "kerf/io/obj/obj_cursor.h"

namespace kerf {
namespace {

struct KeywordEntry {
  std::string_view word;
  MtlKeyword keyword;
};

constexpr KeywordEntry kKeywords[] = {
    {"newmtl", MtlKeyword::newmtl}, {"Kd", MtlKeyword::diffuse},      {"Ks", MtlKeyword::specular},
    {"Ke", MtlKeyword::emission},   {"Ns", MtlKeyword::shininess},    {"Ni", MtlKeyword::refractive_index},
    {"d", MtlKeyword::dissolve},    {"Tr", MtlKeyword::transparency}, {"illum", MtlKeyword::illumination},
    {"Pr", MtlKeyword::roughness},  {"Pm", MtlKeyword::metallic},     {"map_Kd", MtlKeyword::albedo_map}};

/// Textures that are not shown.
constexpr std::string_view kOtherMaps[] = {
    "map_Ka",     "map_Ks",     "map_Ke",      "map_Ns",       "map_d",        "map_Tr",   "map_Tf",
    "map_Ni",     "map_Pr",     "map_Pm",      "map_Ps",       "map_Pc",       "map_Pcr",  "map_RMA",
    "map_ORM",    "map_AO",     "map_Kn",      "bump",         "map_bump",     "disp",     "map_disp",
    "decal",      "map_decal",  "refl",        "map_refl",     "norm",         "map_norm", "map_aniso",
    "map_anisor", "map_normal", "map_opacity", "map_emissive", "map_occlusion"};

/// Properties that no material of Kerf has.
constexpr std::string_view kPassedOver[] = {"Ka",  "Tf",    "Km",     "Kt",        "Ps",     "Pc",
                                            "Pcr", "aniso", "anisor", "sharpness", "map_aat"};

constexpr MtlMapOption kMapOptions[] = {{"-blendu", 1, 1}, {"-blendv", 1, 1},    {"-bm", 1, 1},      {"-boost", 1, 1},
                                        {"-cc", 1, 1},     {"-clamp", 1, 1},     {"-imfchan", 1, 1}, {"-mm", 2, 2},
                                        {"-o", 1, 3},      {"-s", 1, 3},         {"-t", 1, 3},       {"-texres", 1, 1},
                                        {"-type", 1, 1},   {"-colorspace", 1, 1}};

[[noreturn]] void fail(const char* what, std::string_view word, const std::vector<std::string_view>& menu) {
  const std::string_view nearest = nearest_word(word, menu);
  throw ObjFault{word.data(), fmt::format("unknown {} {}{}", what, quoted(word),
                                          nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest))};
}

}  // namespace

MtlKeyword find_mtl_keyword(std::string_view word) {
  const auto is_word = [&](std::string_view known) { return equals_ignoring_case(known, word); };
  for (const KeywordEntry& entry : kKeywords) {
    if (is_word(entry.word)) return entry.keyword;
  }
  if (std::any_of(std::begin(kOtherMaps), std::end(kOtherMaps), is_word)) return MtlKeyword::other_map;
  if (std::any_of(std::begin(kPassedOver), std::end(kPassedOver), is_word)) return MtlKeyword::passed_over;
  std::vector<std::string_view> menu;
  for (const KeywordEntry& entry : kKeywords) menu.push_back(entry.word);
  menu.insert(menu.end(), std::begin(kOtherMaps), std::end(kOtherMaps));
  menu.insert(menu.end(), std::begin(kPassedOver), std::end(kPassedOver));
  fail("keyword", word, menu);
}

const MtlMapOption& find_mtl_map_option(std::string_view word) {
  std::vector<std::string_view> menu;
  for (const MtlMapOption& option : kMapOptions) {
    if (equals_ignoring_case(option.word, word)) return option;
    menu.push_back(option.word);
  }
  fail("option", word, menu);
}

}  // namespace kerf
