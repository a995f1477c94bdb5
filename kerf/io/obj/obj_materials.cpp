#include "kerf/io/obj/obj_materials.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <unordered_map>
#include <unordered_set>

#include "kerf/base/error.h"
#include "kerf/base/nearest_word.h"
#include "kerf/io/mapped_file.h"
#include "kerf/io/message.h"
#include "kerf/io/obj/mtl.h"
#include "kerf/io/obj/obj_cursor.h"
#include "kerf/io/texture_read.h"

namespace kerf {
namespace {

using std::filesystem::path;  // brings std::quoted() along, which is not ours

/// The file that is named in another one, relative to its folder, with slashes of either kind; empty where there is
/// none. Only regular files: a device could be read without end.
std::string find_named(const path& folder, std::string name) {
  if (name.empty() || name.find('\0') != name.npos) return {};
  std::replace(name.begin(), name.end(), '\\', '/');
  const path candidate = folder / name;
  std::error_code ignored;
  return std::filesystem::is_regular_file(candidate, ignored) ? candidate.lexically_normal().string() : std::string();
}

/// As find_named(), or else the file of this name in the folder itself: models are moved without the folders that they
/// were made in.
std::string find_moved(const path& folder, const std::string& name) {
  std::string found = find_named(folder, name);
  if (found.empty()) found = find_named(folder, name.substr(name.find_last_of("/\\") + 1));
  return found;
}

std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words;
  for (size_t begin = text.find_first_not_of(" \t"); begin != text.npos;) {
    const size_t end = std::min(text.find_first_of(" \t", begin), text.size());
    words.push_back(text.substr(begin, end - begin));
    begin = text.find_first_not_of(" \t", end);
  }
  return words;
}

/// A material and the folder that its texture's name is relative to.
struct FoundMaterial {
  MtlMaterial made;
  path folder;
};

/// The materials of all libraries.
class Libraries {
 public:
  Libraries(path folder, std::vector<std::string>& notes) : folder_(std::move(folder)), notes_(notes) {}

  /// Loads what a mtllib statement names: one file, of which the name may have blanks, or several.
  void load(const std::string& names) {
    if (const std::string whole = find_named(folder_, names); !whole.empty()) return load_file(whole);
    const std::vector<std::string> words = words_of(names);
    const auto is_missing = [&](const std::string& word) { return find_moved(folder_, word).empty(); };
    if (std::any_of(words.begin(), words.end(), is_missing)) {
      if (const std::string whole = find_moved(folder_, names); !whole.empty()) return load_file(whole);
    }
    for (const std::string& word : words) load_one(word);
  }

  const FoundMaterial* find(const std::string& name) const {
    const auto found = materials_.find(name);
    return found == materials_.end() ? nullptr : &found->second;
  }

  /// Whether every material there is has been loaded.
  bool complete() const { return !loaded_.empty() && missing_.empty(); }
  bool none() const { return loaded_.empty() && missing_.empty(); }

  /// Says which materials stand in more than one library.
  void note_doubles() {
    if (doubles_ == 0) return;
    const std::string more = doubles_ == 1 ? "" : fmt::format(" and {} more", doubles_ - 1);
    notes_.push_back(fmt::format("the first of several material libraries counts for the material {}{}",
                                 kerf::quoted(first_double_), more));
  }

  std::string_view nearest(const std::string& name) const {
    std::vector<std::string_view> names;
    for (const auto& entry : materials_) names.push_back(entry.first);
    std::sort(names.begin(), names.end());
    return nearest_word(name, names);
  }

 private:
  void load_one(const std::string& name) {
    if (const std::string found = find_moved(folder_, name); !found.empty()) return load_file(found);
    if (!missing_.insert(name).second) return;
    notes_.push_back(
        fmt::format("the material library {} was not found; default materials are used", kerf::quoted(name)));
  }

  void load_file(const std::string& file) {
    if (!loaded_.insert(file).second) return;
    MtlLibrary library = parse_mtl(MappedFile(file).bytes(), file);
    for (MtlMaterial& made : library.materials) {
      const std::string name = made.material.name;
      if (materials_.try_emplace(name, FoundMaterial{std::move(made), path(file).parent_path()}).second) continue;
      if (doubles_++ == 0) first_double_ = name;
    }
    for (const std::string& sentence : library.notes) note(sentence);
  }

  void note(const std::string& sentence) {
    if (std::find(notes_.begin(), notes_.end(), sentence) == notes_.end()) notes_.push_back(sentence);
  }

  path folder_;
  std::vector<std::string>& notes_;
  std::unordered_map<std::string, FoundMaterial> materials_;
  std::unordered_set<std::string> loaded_, missing_;
  std::string first_double_;
  size_t doubles_ = 0;
};

/// The textures of a model, each file once.
class Textures {
 public:
  Textures(std::vector<Texture>& textures, std::vector<std::string>& notes) : textures_(textures), notes_(notes) {}

  /// The number of the texture; kNoTexture with a note where there is none.
  uint32_t load(const path& folder, const std::string& name) {
    const std::string file = find_moved(folder, name);
    const auto [entry, is_new] = numbers_.try_emplace(file.empty() ? name : file, kNoTexture);
    if (!is_new) return entry->second;
    if (file.empty()) {
      notes_.push_back(fmt::format("the texture {} was not found", kerf::quoted(name)));
    } else if (std::optional<Texture> texture = read(file)) {
      entry->second = static_cast<uint32_t>(textures_.size());
      textures_.push_back(std::move(*texture));
    }
    return entry->second;
  }

 private:
  /// A file in a format that Kerf does not know loses no more than its colours; one that is damaged is an error.
  std::optional<Texture> read(const std::string& file) {
    const MappedFile mapped(file);
    if (!is_texture(mapped.bytes(), file)) {
      notes_.push_back(fmt::format("the texture {} is not shown: it is not a PNG, JPEG, TGA or BMP",
                                   kerf::quoted(path(file).filename().string())));
      return std::nullopt;
    }
    return decode_texture(mapped.bytes(), file);
  }

  std::vector<Texture>& textures_;
  std::vector<std::string>& notes_;
  std::unordered_map<std::string, uint32_t> numbers_;
};

/// A usemtl statement and the triangles that it is for.
struct MaterialUse {
  std::string name;
  const char* at;
  uint64_t begin, end;
};

std::vector<MaterialUse> material_uses(std::span<const ObjChunk> chunks) {
  std::vector<MaterialUse> uses;
  for (const ObjChunk& chunk : chunks) {
    for (const ObjName& used : chunk.materials) {
      const uint64_t begin = chunk.before.triangles + used.triangle;
      if (!uses.empty()) uses.back().end = begin;
      uses.push_back({obj_name(used.name), used.at, begin, begin});
    }
  }
  if (!uses.empty()) uses.back().end = total_counts(chunks).triangles;
  return uses;
}

/// The materials of a model, in the order of their first use.
class UsedMaterials {
 public:
  UsedMaterials(const Libraries& libraries, Model& model)
      : libraries_(libraries), model_(model), textures_(model.textures, model.notes) {}

  /// The number of the material; a default one of this name where no library has it.
  uint32_t number(const std::string& name) {
    const auto [entry, is_new] = numbers_.try_emplace(name, static_cast<uint32_t>(model_.materials.size()));
    if (is_new) model_.materials.push_back(make(name));
    return entry->second;
  }

 private:
  Material make(const std::string& name) {
    const FoundMaterial* found = libraries_.find(name);
    if (found == nullptr) {
      Material material;
      material.name = name.empty() ? "default" : name;
      return material;
    }
    Material material = found->made.material;
    if (!found->made.albedo_map.empty()) {
      const Material without;
      material.albedo_texture = textures_.load(found->folder, found->made.albedo_map);
      const bool has_texture = material.albedo_texture != kNoTexture;
      if (found->made.is_map_alone) material.albedo = has_texture ? Vec3f{1, 1, 1} : without.albedo;
    }
    return material;
  }

  const Libraries& libraries_;
  Model& model_;
  Textures textures_;
  std::unordered_map<std::string, uint32_t> numbers_;
};

}  // namespace

void add_obj_materials(std::span<const char> text, std::span<const ObjChunk> chunks, const std::string& name,
                       Model& model) {
  Libraries libraries(path(name).parent_path(), model.notes);
  for (const ObjChunk& chunk : chunks) {
    for (const ObjName& library : chunk.libraries) libraries.load(obj_name(library.name));
  }
  libraries.note_doubles();
  const std::vector<MaterialUse> uses = material_uses(chunks);
  if (uses.empty()) return;
  if (libraries.none()) model.notes.emplace_back("it names materials, but no library (mtllib); default ones are used");

  UsedMaterials used(libraries, model);
  std::vector<uint32_t>& materials = model.mesh.materials;
  materials.resize(model.mesh.triangles.size());
  if (uses[0].begin > 0) std::fill_n(materials.begin(), uses[0].begin, used.number(""));
  for (const MaterialUse& use : uses) {
    if (!use.name.empty() && libraries.complete() && libraries.find(use.name) == nullptr) {
      const std::string_view nearest = libraries.nearest(use.name);
      throw obj_error(
          text, name,
          {use.at, fmt::format("no material library has the material {}{}", kerf::quoted(use.name),
                               nearest.empty() ? "" : fmt::format("; did you mean {}?", kerf::quoted(nearest)))});
    }
    if (use.begin == use.end) continue;
    std::fill(materials.begin() + static_cast<ptrdiff_t>(use.begin),
              materials.begin() + static_cast<ptrdiff_t>(use.end), used.number(use.name));
  }
}

}  // namespace kerf
