#include "kerf/io/obj/mtl.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <unordered_set>

#include "kerf/base/letter_case.h"
#include "kerf/io/message.h"
#include "kerf/io/obj/mtl_keywords.h"
#include "kerf/io/obj/obj_cursor.h"
#include "kerf/io/text_number.h"

namespace kerf {
namespace {

/// Sentences of which each kind is said once, with the first material that it is about.
class NoteBook {
 public:
  void add(const std::string& sentence, const std::string& material) {
    for (Entry& entry : entries_) {
      if (entry.sentence != sentence) continue;
      entry.count += entry.last == material ? 0 : 1;
      entry.last = material;
      return;
    }
    entries_.push_back({sentence, material, material, 1});
  }

  std::vector<std::string> sentences() const {
    std::vector<std::string> all;
    for (const Entry& entry : entries_) {
      const std::string more = entry.count == 1 ? "" : fmt::format(" and {} more", entry.count - 1);
      all.push_back(fmt::format("{} (material {}{})", entry.sentence, quoted(entry.first), more));
    }
    return all;
  }

 private:
  struct Entry {
    std::string sentence, first, last;
    size_t count;
  };
  std::vector<Entry> entries_;
};

/// The statements of one material that have an effect.
struct Statements {
  std::string name;
  std::optional<Vec3f> diffuse, specular, emission;
  std::optional<float> shininess, refractive_index, dissolve, transparency, roughness, metallic;
  int illumination = 2;
  const char* refractive_index_at = nullptr;
  std::string albedo_map;
};

constexpr Vec3f kBlack{0, 0, 0}, kWhite{1, 1, 1};

class MtlParser {
 public:
  explicit MtlParser(std::span<const char> text) : cursor_(text.data(), text.data() + text.size()) {}

  MtlLibrary parse() {
    while (cursor_.next_statement()) {
      const std::string_view word = cursor_.word();
      const MtlKeyword keyword = find_mtl_keyword(word);
      if (keyword != MtlKeyword::newmtl && !has_material_) {
        throw ObjFault{word.data(), fmt::format("{} stands before the first newmtl", quoted(word))};
      }
      read_statement(keyword, word);
    }
    if (has_material_) finish_material();
    library_.notes = notes_.sentences();
    return std::move(library_);
  }

 private:
  void read_statement(MtlKeyword keyword, std::string_view word) {
    switch (keyword) {
      case MtlKeyword::newmtl:
        return begin_material();
      case MtlKeyword::diffuse:
        return read_color("Kd", true, now_.diffuse);
      case MtlKeyword::specular:
        return read_color("Ks", true, now_.specular);
      case MtlKeyword::emission:
        return read_color("Ke", false, now_.emission);
      case MtlKeyword::shininess:
        return read_shininess();
      case MtlKeyword::refractive_index:
        return read_refractive_index();
      case MtlKeyword::dissolve:
        if (!cursor_.ends() && equals_ignoring_case(peek(), "-halo")) cursor_.word();
        return read_share("d", now_.dissolve);
      case MtlKeyword::transparency:
        return read_share("Tr", now_.transparency);
      case MtlKeyword::illumination:
        return read_illumination();
      case MtlKeyword::roughness:
        return read_share("Pr", now_.roughness);
      case MtlKeyword::metallic:
        return read_share("Pm", now_.metallic);
      case MtlKeyword::albedo_map:
        return read_albedo_map();
      case MtlKeyword::other_map:
        note(fmt::format("{} is not shown", word));
        [[fallthrough]];
      case MtlKeyword::passed_over:
        return cursor_.skip_statement();
    }
  }

  void note(const std::string& sentence) { notes_.add(sentence, now_.name); }

  std::string_view peek() {
    const char* const here = cursor_.position();
    const std::string_view word = cursor_.word();
    cursor_.move_to(here);
    return word;
  }

  void begin_material() {
    if (has_material_) finish_material();
    now_ = {};
    now_.name = obj_name(cursor_.rest());
    if (now_.name.empty()) cursor_.fail_missing("the name of a material");
    has_material_ = true;
  }

  /// A finite number.
  float read_number(std::string_view what) {
    const bool ends = cursor_.ends();
    const char* const at = cursor_.position();
    const float value = cursor_.number(what);
    if (!ends && !std::isfinite(value)) {
      throw ObjFault{at, fmt::format("{} is {}; a finite number was expected", what, value)};
    }
    return value;
  }

  float read_positive(std::string_view what) {
    cursor_.ends();
    const char* const at = cursor_.position();
    const float value = read_number(what);
    if (value < 0) throw ObjFault{at, fmt::format("{} is {}; it must not be negative", what, value)};
    return value;
  }

  float at_most_one(std::string_view what, float value) {
    if (value > 1) note(fmt::format("{} above 1 is taken as 1", what));
    return std::min(value, 1.0F);
  }

  void read_share(std::string_view what, std::optional<float>& share) {
    share = at_most_one(what, read_positive(what));
    cursor_.expect_end(what);
  }

  void read_color(std::string_view what, bool is_share, std::optional<Vec3f>& color) {
    if (!cursor_.ends() && (equals_ignoring_case(peek(), "spectral") || equals_ignoring_case(peek(), "xyz"))) {
      note(fmt::format("{} is passed over where it is given as '{}'", what, peek()));
      return cursor_.skip_statement();
    }
    Vec3f value;
    value.x = read_positive(what);
    value.y = value.z = value.x;  // a single number is a grey
    if (!cursor_.ends()) {
      value.y = read_positive(what);
      value.z = read_positive(what);
    }
    cursor_.expect_end(what);
    if (is_share) value = {at_most_one(what, value.x), at_most_one(what, value.y), at_most_one(what, value.z)};
    color = value;
  }

  void read_shininess() {
    const float value = read_number("Ns");
    if (value < 0) note("Ns below 0 is taken as 0");  // written by some programs for the dullest
    now_.shininess = std::max(value, 0.0F);
    cursor_.expect_end("Ns");
  }

  void read_refractive_index() {
    cursor_.ends();
    now_.refractive_index_at = cursor_.position();
    now_.refractive_index = read_number("Ni");
    cursor_.expect_end("Ni");
  }

  void read_illumination() {
    if (cursor_.ends()) cursor_.fail_missing("a number of an illumination model");
    const std::string_view word = cursor_.word();
    int value = -1;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size() || value < 0 || value > 10) {
      cursor_.fail_word(word.data(), "an illumination model from 0 to 10");
    }
    now_.illumination = value;
    cursor_.expect_end("illum");
  }

  void read_albedo_map() {
    while (!cursor_.ends() && *cursor_.position() == '-') read_map_option();
    const std::string name = obj_name(cursor_.rest());
    if (name.empty()) note("map_Kd names no file");
    now_.albedo_map = name;
  }

  void read_map_option() {
    const MtlMapOption& option = find_mtl_map_option(cursor_.word());
    for (int i = 0; i < option.most; ++i) {
      if (cursor_.ends()) cursor_.fail_missing(fmt::format("a value of {}", option.word));
      // A file's name may follow already where not all three numbers are there.
      if (i >= option.least && !is_number(peek())) break;
      cursor_.word();
    }
    note(fmt::format("the option {} of map_Kd is passed over", option.word));
  }

  static bool is_number(std::string_view word) {
    float value = 0;
    return parse_float(word.data(), word.data() + word.size(), value) == word.data() + word.size();
  }

  void finish_material() {
    if (!names_.insert(now_.name).second) {
      note("a second material of the same name is left out");
      return;
    }
    MtlMaterial made;
    Material& material = made.material;
    material.name = now_.name;
    material.albedo = now_.diffuse.value_or(material.albedo);
    material.emission = now_.emission.value_or(kBlack);
    made.albedo_map = now_.albedo_map;
    made.is_map_alone = !made.albedo_map.empty() && now_.diffuse.value_or(kBlack) == kBlack;
    const int illumination = now_.illumination;
    const bool is_mirror = illumination == 3 || illumination == 5;
    if (illumination == 4 || illumination == 6 || illumination == 7 || illumination == 9) {
      make_glass(material);
      if (!made.albedo_map.empty()) note("map_Kd of glass is not shown");
      made.albedo_map.clear();
    } else if (is_mirror || now_.metallic.value_or(0) > 0) {
      make_metal(material, is_mirror);
    } else if (opacity() < 1) {
      make_see_through(material);
    }
    library_.materials.push_back(std::move(made));
  }

  float opacity() {
    if (now_.dissolve) return *now_.dissolve;
    if (now_.transparency == 1.0F) {
      note("Tr 1 without d is taken as opaque");
      return 1;
    }
    return 1 - now_.transparency.value_or(0);
  }

  void make_glass(Material& material) {
    material.type = MaterialType::glass;
    material.albedo = kWhite;
    set_refractive_index(material, material.refractive_index);
    if (const float opaque = opacity(); opaque < 1) material.transmission = 1 - opaque;
  }

  void make_see_through(Material& material) {
    material.type = MaterialType::glass;
    if (material.albedo == kBlack) material.albedo = kWhite;
    set_refractive_index(material, 1);
    material.transmission = 1 - opacity();
  }

  void set_refractive_index(Material& material, float without) {
    material.refractive_index = now_.refractive_index.value_or(without);
    if (material.refractive_index > 0) return;
    throw ObjFault{now_.refractive_index_at,
                   fmt::format("Ni is {}; that of glass must be greater than 0", material.refractive_index)};
  }

  void make_metal(Material& material, bool is_mirror) {
    material.type = MaterialType::metal;
    material.metallic = now_.metallic.value_or(1);
    const bool has_base_color = now_.metallic.has_value() || !now_.albedo_map.empty();
    if (!has_base_color && now_.specular.value_or(kBlack) != kBlack) material.albedo = *now_.specular;
    if (now_.roughness) {
      material.roughness = *now_.roughness;
    } else if (now_.shininess) {
      material.roughness = std::pow(2 / (*now_.shininess + 2), 0.25F);
    } else {
      material.roughness = is_mirror ? 0 : 0.5F;
    }
  }

  ObjCursor cursor_;
  Statements now_;
  bool has_material_ = false;
  std::unordered_set<std::string> names_;
  NoteBook notes_;
  MtlLibrary library_;
};

}  // namespace

MtlLibrary parse_mtl(std::span<const char> bytes, const std::string& name) {
  const std::span<const char> text = obj_text(bytes, name);
  try {
    return MtlParser(text).parse();
  } catch (const ObjFault& fault) {
    throw obj_error(text, name, fault);
  }
}

}  // namespace kerf
