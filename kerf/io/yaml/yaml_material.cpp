#include "kerf/io/yaml/yaml_material.h"

#include <fmt/format.h>

#include <algorithm>

#include "kerf/base/nearest_word.h"
#include "kerf/io/message.h"

namespace kerf {
namespace {

constexpr std::string_view kKeys[] = {
    "name",      "type",     "albedo",           "emission",    "color", "emission_intensity",
    "roughness", "metallic", "refractive_index", "transmission"};

struct Synonym {
  std::string_view word;
  MaterialType type;
};
constexpr Synonym kSynonyms[] = {{"rough_mirror", MaterialType::metal}, {"dielectric", MaterialType::glass}};

constexpr std::string_view kFutureTypes[] = {"anisotropic_metal", "thin_film", "clear_coat"};

struct FutureKey {
  std::string_view key, owner;
};
constexpr FutureKey kFutureKeys[] = {{"pattern", ""},
                                     {"dot_count", "pattern"},
                                     {"dot_radius", "pattern"},
                                     {"film_thickness", "thin_film"},
                                     {"film_ior", "thin_film"},
                                     {"anisotropy", "anisotropic_metal"},
                                     {"preset", "anisotropic_metal"},
                                     {"eta", "anisotropic_metal"},
                                     {"k", "anisotropic_metal"}};

MaterialType read_type(const YamlField& field) {
  const std::string word = field.text();
  for (const MaterialTypeEntry& entry : material_types()) {
    if (entry.name == word) return entry.type;
  }
  for (const Synonym& synonym : kSynonyms) {
    if (synonym.word == word) return synonym.type;
  }
  if (std::find(std::begin(kFutureTypes), std::end(kFutureTypes), word) != std::end(kFutureTypes)) {
    field.node().fail(fmt::format("the material type '{}' is not there yet", word));
  }
  std::vector<std::string_view> menu;
  for (const MaterialTypeEntry& entry : material_types()) menu.push_back(entry.name);
  for (const Synonym& synonym : kSynonyms) menu.push_back(synonym.word);
  field.node().fail(fmt::format("unknown material type {}", quoted(word)) + suggestion(word, menu));
}

std::string noun_of(MaterialType type) {
  if (type == MaterialType::light) return "a light";
  return fmt::format("a {} material", material_types()[static_cast<size_t>(type)].name);
}

void refuse_future_keys(const YamlNode& map) {
  for (size_t i = 0; i < map.size(); ++i) {
    const YamlNode key = map.key(i);
    if (key.kind() != YamlKind::scalar) continue;
    const auto is_it = [&](const FutureKey& future) { return future.key == key.text(); };
    const auto* future = std::find_if(std::begin(kFutureKeys), std::end(kFutureKeys), is_it);
    if (future == std::end(kFutureKeys)) continue;
    if (future->owner.empty()) key.fail(fmt::format("'{}' is not there yet", future->key));
    key.fail(fmt::format("'{}' belongs to {}, which is not there yet", future->key, future->owner));
  }
}

/// Reads one material, its type known.
class MaterialReader {
 public:
  MaterialReader(const YamlField& item, MaterialType type, Notes& notes)
      : map_(item, kKeys, noun_of(type)), type_(type), notes_(notes) {}

  Material read() {
    Material material;
    material.type = type_;
    if (type_ == MaterialType::glass) material.albedo = {1, 1, 1};
    read_albedo(material);
    read_number("roughness", type_ == MaterialType::metal, kShare, material.roughness);
    read_number("metallic", type_ == MaterialType::metal, kShare, material.metallic);
    read_number("refractive_index", type_ == MaterialType::glass, kAboveZero, material.refractive_index);
    read_number("transmission", type_ == MaterialType::glass, kShare, material.transmission);
    material.emission = read_emission();
    return material;
  }

  const YamlMap& map() const { return map_; }

 private:
  void note_unused(std::string_view key) {
    notes_.add(fmt::format("{} does not use '{}'", map_.noun(), key), map_.key_node(key).place());
  }

  void read_albedo(Material& material) {
    const std::optional<YamlField> field = map_.find("albedo");
    if (!field) return;
    if (type_ == MaterialType::light || type_ == MaterialType::show_normals) {
      field->vector();
      note_unused("albedo");
      return;
    }
    material.albedo = field->single_vector(type_ == MaterialType::constant ? kAtLeastZero : kShare);
  }

  /// Without a use the value must be a number all the same, but any.
  void read_number(std::string_view key, bool is_used, const YamlRange& range, float& value) {
    const std::optional<YamlField> field = map_.find(key);
    if (!field) return;
    if (is_used) {
      value = field->single(range);
    } else {
      field->number();
      note_unused(key);
    }
  }

  Vec3f read_emission() {
    const std::optional<YamlField> emission = map_.find("emission"), color = map_.find("color");
    const std::optional<YamlField> intensity = map_.find("emission_intensity");
    const std::optional<YamlField>& other = color ? color : intensity;
    if (emission && other) refuse_both(map_.key_node("emission"), map_.key_node(other->key()));
    Vec3f radiance;
    if (emission) radiance = emission->single_vector(kAtLeastZero);
    if (other) radiance = product(color, intensity);
    if (type_ == MaterialType::light && radiance == Vec3f{}) {
      const YamlNode& place = emission ? emission->node() : other ? other->node() : map_.node();
      place.fail("a light needs an 'emission', or a 'color' and an 'emission_intensity', above 0");
    }
    return radiance;
  }

  Vec3f product(const std::optional<YamlField>& color, const std::optional<YamlField>& intensity) {
    const Vec3d shade = color ? color->vector(kAtLeastZero) : Vec3d{1, 1, 1};
    const Vec3d radiance = shade * (intensity ? intensity->number(kAtLeastZero) : 1);
    if (largest(radiance) > kMaxCoordinate) intensity->fail("times 'color' it is greater than 2^120 (1.3e36)");
    if (!intensity && type_ != MaterialType::light) {
      notes_.add(
          fmt::format("'color' without 'emission_intensity' makes {} shine with intensity 1; what it reflects is "
                      "its 'albedo'",
                      map_.noun()),
          map_.key_node("color").place());
    }
    return to_float(radiance);
  }

  YamlMap map_;
  MaterialType type_;
  Notes& notes_;
};

}  // namespace

void YamlMaterials::read(const YamlField& section, Notes& notes) {
  for (const YamlField& item : items_of(section)) {
    const std::optional<YamlField> word = peek(item, "type");
    const MaterialType type = word ? read_type(*word) : MaterialType::lambertian;
    refuse_future_keys(item.node());
    MaterialReader reader(item, type, notes);
    Material material = reader.read();
    const YamlField name = reader.map().require("name");
    material.name = name.text();
    const Known known{static_cast<uint32_t>(materials_.size()), name.node().line()};
    const auto [first, is_new] = known_.emplace(material.name, known);
    if (!is_new) {
      name.node().fail(
          fmt::format("a second material {}; the first is in line {}", quoted(material.name), first->second.line));
    }
    materials_.push_back(std::move(material));
  }
}

uint32_t YamlMaterials::number_of(const YamlField& name) const {
  const std::string word = name.text();
  if (const auto found = known_.find(word); found != known_.end()) return found->second.number;
  std::vector<std::string_view> menu;
  menu.reserve(materials_.size());
  for (const Material& material : materials_) menu.push_back(material.name);
  const std::string_view near = nearest_word(word, menu);
  std::string hint;
  if (!near.empty()) {
    hint = fmt::format("; did you mean {}?", quoted(near));
  } else if (menu.empty()) {
    hint = "; the file has no materials";
  } else {
    constexpr size_t kMost = 8;
    for (size_t i = 0; i < std::min(menu.size(), kMost); ++i) hint += (i == 0 ? "; there is " : ", ") + quoted(menu[i]);
    if (menu.size() > kMost) hint += fmt::format(" and {} more", menu.size() - kMost);
  }
  name.node().fail(fmt::format("unknown material {}", quoted(word)) + hint);
}

}  // namespace kerf
