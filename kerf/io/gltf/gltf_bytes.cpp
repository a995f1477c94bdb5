#include "kerf/io/gltf/gltf_bytes.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>

#include "kerf/base/error.h"
#include "kerf/io/message.h"
#include "kerf/io/notes.h"

namespace kerf {
namespace {

constexpr uint8_t kNoDigit = 0xFF;

constexpr std::array<uint8_t, 256> make_base64_digits() {
  constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::array<uint8_t, 256> digits{};
  for (uint8_t& digit : digits) digit = kNoDigit;
  for (size_t i = 0; i < kAlphabet.size(); ++i)
    digits[static_cast<unsigned char>(kAlphabet[i])] = static_cast<uint8_t>(i);
  return digits;
}

/// Nothing where the text is no base64.
std::optional<std::vector<char>> decode_base64(std::string_view text) {
  static constexpr std::array<uint8_t, 256> kDigits = make_base64_digits();
  for (int i = 0; i < 2 && text.ends_with('='); ++i) text.remove_suffix(1);
  if (text.size() % 4 == 1) return {};
  std::vector<char> bytes;
  bytes.reserve(text.size() / 4 * 3 + 2);
  uint32_t bits = 0, count = 0;
  for (const char c : text) {
    const uint8_t digit = kDigits[static_cast<unsigned char>(c)];
    if (digit == kNoDigit) return {};
    bits = bits << 6 | digit;
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<char>(bits >> count & 0xFF));
  }
  return bytes;
}

int hex_digit(char c) {
  const size_t digit = std::string_view("0123456789abcdef0123456789ABCDEF").find(c);
  return digit == std::string_view::npos ? -1 : static_cast<int>(digit % 16);
}

/// A relative URI as a name of a file: %20 is a space. A plus is a plus.
std::string percent_decoded(std::string_view uri) {
  std::string name;
  for (size_t i = 0; i < uri.size(); ++i) {
    const bool is_code =
        uri[i] == '%' && i + 2 < uri.size() && hex_digit(uri[i + 1]) >= 0 && hex_digit(uri[i + 2]) >= 0;
    name += is_code ? static_cast<char>(hex_digit(uri[i + 1]) * 16 + hex_digit(uri[i + 2])) : uri[i];
    if (is_code) i += 2;
  }
  return name;
}

/// "http" of "http://example.org"; empty for the name of a file. One letter is a drive.
std::string_view scheme_of(std::string_view uri) {
  const size_t colon = uri.find(':');
  if (colon == std::string_view::npos || colon < 2) return {};
  const std::string_view scheme = uri.substr(0, colon);
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789+.-";
  return scheme.find_first_not_of(kLetters) == std::string_view::npos ? scheme : std::string_view();
}

}  // namespace

GltfBytes::GltfBytes(const std::string& path, std::vector<GltfBuffer> buffers, std::vector<GltfImage> images,
                     std::optional<std::span<const char>> binary)
    : path_(path),
      buffers_(std::move(buffers)),
      images_(std::move(images)),
      binary_(binary),
      open_buffers_(buffers_.size()) {}

void GltfBytes::fail(const std::string& name, const std::string& sentence) const {
  throw Error(ErrorCode::file, path_, fmt::format("{} {}", name, sentence));
}

std::span<const char> GltfBytes::buffer(size_t number) {
  const std::string name = fmt::format("buffers[{}]", number);
  if (number >= buffers_.size()) fail(name, fmt::format("is not there; the file has {}", buffers_.size()));
  if (open_buffers_[number]) return *open_buffers_[number];
  const GltfBuffer& buffer = buffers_[number];
  if (!buffer.byte_length) fail(name, "has no byteLength");
  std::span<const char> bytes;
  if (buffer.uri) {
    bytes = open(*buffer.uri, name);
  } else if (number == 0 && binary_) {
    bytes = *binary_;
  } else {
    fail(name, "has no uri, and there is no binary chunk for it");
  }
  if (bytes.size() < *buffer.byte_length) {
    fail(name, fmt::format("has {} bytes; its byteLength is {}", bytes.size(), *buffer.byte_length));
  }
  open_bytes_ += *buffer.byte_length;
  open_buffers_[number] = bytes.first(*buffer.byte_length);
  return *open_buffers_[number];
}

std::span<const char> GltfBytes::image(size_t number) {
  const std::string name = fmt::format("images[{}]", number);
  if (!images_[number].uri) fail(name, "has neither a uri nor a bufferView");
  return open(*images_[number].uri, name);
}

std::span<const char> GltfBytes::open(std::string_view raw_uri, const std::string& name) {
  // Only where there is something to unescape: embedded data may be large.
  const bool is_plain = raw_uri.find('\\') == std::string_view::npos;
  const std::string unescaped = is_plain ? std::string() : unescape_json(raw_uri);
  const std::string_view uri = is_plain ? raw_uri : std::string_view(unescaped);
  const std::string_view scheme = scheme_of(uri);
  if (scheme.empty()) return open_file(std::string(uri), name);
  if (scheme != "data") fail(name, fmt::format("is at {}; only files and data: URIs can be read", kerf::quoted(uri)));
  const size_t comma = uri.find(',');
  if (comma == std::string_view::npos || !uri.substr(0, comma).ends_with(";base64")) {
    fail(name, "has a data: URI that is not in base64");
  }
  std::optional<std::vector<char>> bytes = decode_base64(uri.substr(comma + 1));
  if (!bytes) fail(name, "has a data: URI with what is not base64");
  return sources_.emplace_back(Source{nullptr, std::move(*bytes)}).decoded;
}

std::span<const char> GltfBytes::open_file(const std::string& uri, const std::string& name) {
  const std::filesystem::path file = std::filesystem::path(path_).parent_path() / percent_decoded(uri);
  // A pipe or a device might never end.
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    fail(name, fmt::format("is at {}, which is not a regular file", kerf::quoted(uri)));
  }
  try {
    Source& source = sources_.emplace_back();
    source.file = std::make_unique<MappedFile>(file.string());
    return source.file->bytes();
  } catch (const Error& inner) {
    fail(name, fmt::format("is at {}: {}", kerf::quoted(uri), sentence_of(inner)));
  }
}

}  // namespace kerf
