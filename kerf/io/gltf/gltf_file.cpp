#include "kerf/io/gltf/gltf_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <new>

#include "kerf/base/error.h"
#include "kerf/io/message.h"

namespace kerf {
namespace {

// What may be required of a reader, and is done.
constexpr std::string_view kSupported[] = {
    "KHR_materials_emissive_strength", "KHR_materials_ior",     "KHR_materials_transmission", "KHR_materials_unlit",
    "KHR_mesh_quantization",           "KHR_texture_transform",
};
// What has a note of its own where it has no effect.
constexpr std::string_view kNoted[] = {"KHR_lights_punctual", "KHR_materials_pbrSpecularGlossiness",
                                       "EXT_mesh_gpu_instancing"};

template <size_t Count>
bool is_in(const std::string_view (&list)[Count], const std::string& word) {
  return std::find(std::begin(list), std::end(list), word) != std::end(list);
}

void check_extensions(GltfFile& file) {
  std::string missing, unused;
  const auto append = [](std::string& list, const std::string& name) {
    constexpr size_t kMost = 400;  // letters; a file may name any number
    if (list.size() < kMost) list += (list.empty() ? "" : ", ") + printable(name);
  };
  for (const std::string& name : file.json.extensionsRequired) {
    if (!is_in(kSupported, name)) append(missing, name);
  }
  if (!missing.empty()) file.fail(fmt::format("requires extensions that cannot be read: {}", missing));
  for (const std::string& name : file.json.extensionsUsed) {
    if (!is_in(kSupported, name) && !is_in(kNoted, name)) append(unused, name);
  }
  if (!unused.empty()) file.notes.add(fmt::format("extensions that have no effect: {}", unused));
}

}  // namespace

void GltfFile::fail(const std::string& sentence) const { throw Error(ErrorCode::file, path, sentence); }

void GltfFile::fail_member(int64_t number, size_t count, std::string_view name, std::string_view user) const {
  fail(fmt::format("{} names {}[{}]; the file has {}", user, name, number, count));
}

std::span<const char> GltfFile::view(int64_t number, std::string_view user) {
  const tinygltf::BufferView& view = member(json.bufferViews, number, "bufferViews", user);
  const std::span<const char> buffer = bytes.buffer(static_cast<size_t>(std::max(view.buffer, 0)));
  if (view.byteOffset > buffer.size() || view.byteLength > buffer.size() - view.byteOffset) {
    fail(fmt::format("bufferViews[{}] has {} bytes from byte {} on; buffers[{}] has {}", number, view.byteLength,
                     view.byteOffset, view.buffer, buffer.size()));
  }
  return buffer.subspan(view.byteOffset, view.byteLength);
}

GltfFile load_gltf(const GltfContainer& container, const std::string& path) {
  GltfText text = take_gltf_apart(container.json, path);
  GltfFile file{path, {}, {path, std::move(text.buffers), std::move(text.images), container.binary}, {}};
  if (text.has_animations) file.notes.add("animations have no effect");
  if (text.json.size() > std::numeric_limits<int32_t>::max()) file.fail("has more than 2 GB of text");
  std::string error, warning;
  bool is_read = false;
  try {
    // There are no buffers and images in this text, so nothing is looked for in the file system.
    is_read = tinygltf::TinyGLTF().LoadASCIIFromString(&file.json, &error, &warning, text.json.data(),
                                                       static_cast<unsigned int>(text.json.size()), "");
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& inner) {
    error = inner.what();
  }
  check_extensions(file);  // first: without one that is required, the rest may make no sense to it
  // It skips a primitive that it cannot read, and says so only here.
  if (!is_read || !error.empty()) file.fail(fmt::format("is no glTF 2.0: {}", first_line(error)));
  if (!file.json.asset.minVersion.empty() && file.json.asset.minVersion != "2.0") {
    file.fail(fmt::format("needs a reader of glTF {}; 2.0 can be read", printable(file.json.asset.minVersion)));
  }
  return file;
}

}  // namespace kerf
