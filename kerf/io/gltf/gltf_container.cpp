#include "kerf/io/gltf/gltf_container.h"

#include <fmt/format.h>

#include "kerf/base/error.h"
#include "kerf/io/byte_order.h"

namespace kerf {
namespace {

constexpr size_t kHeaderSize = 12, kChunkHeaderSize = 8;
constexpr uint32_t kJson = 0x4E4F534A, kBinary = 0x004E4942;

uint32_t number_at(std::span<const char> bytes, size_t offset) {
  return load_number<uint32_t>(bytes.data() + offset, !kLittleEndianHost);
}

}  // namespace

GltfContainer open_gltf_container(std::span<const char> bytes, const std::string& path) {
  const std::string_view text(bytes.data(), bytes.size());
  if (!text.starts_with("glTF")) return {text, {}};
  const auto fail = [&](const std::string& sentence) { throw Error(ErrorCode::file, path, sentence); };

  if (bytes.size() < kHeaderSize)
    fail(fmt::format("is cut short in the header of a GLB, after {} bytes", bytes.size()));
  if (const uint32_t version = number_at(bytes, 4); version != 2) {
    fail(fmt::format("is a GLB of version {}; only 2 can be read", version));
  }
  const uint32_t length = number_at(bytes, 8);
  if (length > bytes.size()) {
    fail(fmt::format("is cut short: its header says {} bytes, and there are {}", length, bytes.size()));
  }
  const std::span<const char> content = bytes.first(length);  // what follows is no part of it

  GltfContainer parts;
  size_t at = kHeaderSize;
  for (size_t chunk = 0; at < length; ++chunk) {
    if (length - at < kChunkHeaderSize) fail(fmt::format("has half a chunk header at byte {}", at));
    const uint32_t size = number_at(content, at);
    const uint32_t type = number_at(content, at + 4);
    at += kChunkHeaderSize;
    if (size > length - at) {
      fail(fmt::format("has a chunk of {} bytes at byte {}, where only {} are left", size, at, length - at));
    }
    if (chunk == 0 && type != kJson) fail("does not begin with a JSON chunk");
    if (chunk == 0) parts.json = text.substr(at, size);
    if (chunk == 1 && type == kBinary) parts.binary = content.subspan(at, size);
    at += size;  // further chunks are for extensions
  }
  if (parts.json.data() == nullptr) fail("has no JSON chunk");
  return parts;
}

}  // namespace kerf
