#include "kerf/io/model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "kerf/base/error.h"
#include "kerf/base/letter_case.h"
#include "kerf/base/nearest_word.h"
#include "kerf/io/assimp_model.h"
#include "kerf/io/gltf.h"
#include "kerf/io/obj.h"
#include "kerf/io/ply.h"
#include "kerf/io/stl.h"

namespace kerf {
namespace {

using ModelReader = Model (*)(const std::string& path);

struct ModelFormat {
  std::string_view extension;
  ModelReader read;
};

constexpr ModelFormat kFormats[] = {
    {".ply", [](const std::string& path) { return Model{read_ply(path)}; }},
    {".obj", read_obj},
    {".stl", [](const std::string& path) { return Model{read_stl(path)}; }},
#ifdef KERF_HAVE_TINYGLTF
    {".gltf", read_gltf},
    {".glb", read_gltf},
#endif
};

/// What a name ends with, from its last point on, in small letters.
std::string extension_of(const std::string& path) {
  return lower_case(std::filesystem::path(path).extension().string());
}

}  // namespace

std::vector<std::string> model_extensions() {
  std::vector<std::string> all;
  for (const ModelFormat& format : kFormats) all.emplace_back(format.extension);
#ifdef KERF_HAVE_ASSIMP
  for (const std::string& extension : assimp_extensions()) {
    if (std::find(all.begin(), all.end(), extension) == all.end()) all.push_back(extension);
  }
#endif
  return all;
}

Model read_model(const std::string& path) {
  const std::string extension = extension_of(path);
  for (const ModelFormat& format : kFormats) {
    if (format.extension == extension) return format.read(path);
  }
  const std::vector<std::string> all = model_extensions();
#ifdef KERF_HAVE_ASSIMP
  if (std::find(all.begin(), all.end(), extension) != all.end()) return read_with_assimp(path);
#endif
  const std::vector<std::string_view> menu(all.begin(), all.end());
  const std::string_view near = nearest_word(extension, menu);
  throw Error(ErrorCode::file, path,
              fmt::format("its name ends with '{}', which no reader of this build knows{}", extension,
                          near.empty() ? "" : fmt::format("; did you mean '{}'?", near)));
}

}  // namespace kerf
