#include "kerf/io/texture/texture_check.h"

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <string_view>

#include "kerf/io/byte_order.h"
#include "kerf/io/message.h"
#include "kerf/io/texture/jpeg_check.h"

namespace kerf {
namespace {

constexpr const char* kCutShort = "is cut short";
constexpr const char* kTooFewBytes = "has fewer bytes than so many pixels can be packed into";

uint64_t little16(const char* from) { return load_number<uint16_t>(from, !kLittleEndianHost); }
uint64_t little32(const char* from) { return load_number<uint32_t>(from, !kLittleEndianHost); }
uint64_t big32(const char* from) { return load_number<uint32_t>(from, kLittleEndianHost); }
uint8_t byte(const char* from) { return static_cast<uint8_t>(*from); }

// --- PNG ------------------------------------------------------------------------------------------------------------

constexpr std::string_view kPngSignature("\x89PNG\r\n\x1A\n");

constexpr std::array<uint32_t, 256> make_checksum_table() {
  std::array<uint32_t, 256> table{};
  for (uint32_t i = 0; i < 256; ++i) {
    uint32_t value = i;
    for (int bit = 0; bit < 8; ++bit) value = (value & 1) != 0 ? 0xEDB88320U ^ (value >> 1) : value >> 1;
    table[i] = value;
  }
  return table;
}

uint32_t checksum(std::string_view bytes) {
  static constexpr std::array<uint32_t, 256> kTable = make_checksum_table();
  uint32_t value = 0xFFFFFFFFU;
  for (const char c : bytes) value = kTable[(value ^ static_cast<uint8_t>(c)) & 0xFF] ^ (value >> 8);
  return ~value;
}

/// What the header says; `data` are the 13 bytes of IHDR.
std::string png_header_fault(std::string_view data, size_t file_size) {
  constexpr uint64_t kMostPacking = 1100;  // deflate makes at most 1032 bytes of one
  const uint64_t width = big32(data.data()), height = big32(data.data() + 4);
  constexpr uint8_t kChannels[] = {1, 0, 3, 1, 2, 0, 4};
  const uint8_t color = byte(data.data() + 9);
  if (color >= sizeof kChannels) return "has an unknown type of colour";
  const uint64_t row = width * kChannels[color] * byte(data.data() + 8) / 8;
  if (height != 0 && row / kMostPacking > file_size / height + 1) return kTooFewBytes;
  return {};
}

std::string png_fault(std::string_view bytes) {
  for (size_t at = kPngSignature.size(); bytes.size() - at >= 12;) {
    const uint64_t size = big32(bytes.data() + at);
    if (size > bytes.size() - at - 12) return kCutShort;
    const std::string_view type = bytes.substr(at + 4, 4);
    const std::string_view data = bytes.substr(at + 8, size);
    const bool is_critical = (byte(type.data()) & 0x20) == 0;
    if (is_critical && checksum(bytes.substr(at + 4, size + 4)) != big32(data.data() + size)) {
      return fmt::format("is damaged: the checksum of its part {} is wrong", printable(type));
    }
    if (at == kPngSignature.size()) {
      if (type != "IHDR" || size != 13) return "is damaged: it does not begin with a header";
      if (std::string fault = png_header_fault(data, bytes.size()); !fault.empty()) return fault;
    }
    if (type == "IEND") return {};
    at += 12 + size;
  }
  return kCutShort;
}

// --- BMP ------------------------------------------------------------------------------------------------------------

/// Whether a pixel has a number that the palette has not: the decoder would show whatever lies in memory there.
bool leaves_palette(std::string_view rows, uint64_t row_size, uint64_t width, uint64_t bits, uint64_t colors) {
  const uint64_t mask = (uint64_t{1} << bits) - 1, per_byte = 8 / bits;
  if (colors > mask) return false;
  for (size_t row = 0; row + row_size <= rows.size(); row += row_size) {
    for (uint64_t x = 0; x < width; ++x) {
      const uint64_t shift = 8 - bits * (x % per_byte + 1);
      if ((byte(rows.data() + row + x / per_byte) >> shift & mask) >= colors) return true;
    }
  }
  return false;
}

std::string bmp_fault(std::string_view bytes) {
  if (bytes.size() < 26) return kCutShort;
  const char* const p = bytes.data();
  const uint64_t offset = little32(p + 10), header = little32(p + 14);
  uint64_t width = 0, height = 0, bits = 0, packing = 0;
  if (header == 12) {
    width = little16(p + 18);
    height = little16(p + 20);
    bits = little16(p + 24);
    if (bits < 16) return "has a palette of the oldest kind, which is not read";  // the decoder takes it for shorter
  } else {
    if (bytes.size() < 54) return kCutShort;
    width = little32(p + 18);
    height = little32(p + 22);
    if (height > 0x7FFFFFFF) height = 0x100000000 - height;  // negative: rows begin at the top
    bits = little16(p + 28);
    packing = little32(p + 30);
  }
  if (packing != 0 && packing != 3) return "is packed in a way that is not read";
  const uint64_t row = (width * bits + 31) / 32 * 4;
  if (offset > bytes.size() || (row != 0 && height > (bytes.size() - offset) / row)) return kCutShort;
  if (bits == 1 || bits == 4 || bits == 8) {
    if (offset < 14 + header) return "is damaged: its pixels begin in its header";
    const uint64_t colors = (offset - 14 - header) / 4;
    if (leaves_palette(bytes.substr(offset, height * row), row, width, bits, colors)) {
      return fmt::format("is damaged: it has pixels beyond its palette of {} colours", colors);
    }
  }
  return {};
}

// --- TGA ------------------------------------------------------------------------------------------------------------

struct TgaHeader {
  explicit TgaHeader(const char* p)
      : name_size(byte(p)),
        has_palette(byte(p + 1)),
        type(byte(p + 2)),
        palette_begin(little16(p + 3)),
        palette_count(little16(p + 5)),
        palette_bits(byte(p + 7)),
        width(little16(p + 12)),
        height(little16(p + 14)),
        bits(byte(p + 16)),
        flags(byte(p + 17)) {}

  bool is_packed() const { return type >= 8; }
  bool is_indexed() const { return (type & 7) == 1; }

  uint64_t name_size, has_palette, type, palette_begin, palette_count, palette_bits, width, height, bits;
  uint8_t flags;
};

bool is_depth(uint64_t bits) { return bits == 8 || bits == 15 || bits == 16 || bits == 24 || bits == 32; }

bool is_tga(std::string_view bytes) {
  if (bytes.size() < 18) return false;
  const TgaHeader header(bytes.data());
  const uint64_t kind = header.type & 7;
  const bool is_type = header.type <= 11 && kind >= 1 && kind <= 3 && (header.type < 4 || header.type > 8);
  if (!is_type || header.has_palette > 1 || header.width == 0 || header.height == 0) return false;
  if (header.is_indexed()) return header.has_palette == 1 && header.bits <= 16 && is_depth(header.palette_bits);
  return is_depth(header.bits);
}

std::string tga_fault(std::string_view bytes) {
  const TgaHeader header(bytes.data());
  // The decoder would read the wrong bytes.
  if (!header.is_indexed() && header.has_palette == 1 && header.palette_count > 0) return "has a palette without use";
  if (header.palette_begin != 0 && header.is_indexed()) return "has a palette that does not begin at 0";
  if ((header.flags & 0x10) != 0) return "has its pixels from right to left, which is not read";
  const uint64_t palette = header.has_palette == 1 ? header.palette_count * ((header.palette_bits + 7) / 8) : 0;
  const uint64_t pixel = (header.bits + 7) / 8, pixels = header.width * header.height;
  uint64_t at = 18 + header.name_size + palette;
  if (!header.is_packed()) return at + pixels * pixel > bytes.size() ? kCutShort : "";
  for (uint64_t done = 0; done < pixels;) {
    if (at >= bytes.size()) return kCutShort;
    const uint8_t head = byte(bytes.data() + at);
    const uint64_t run = (head & 0x7FU) + 1;
    at += 1 + ((head & 0x80U) != 0 ? 1 : run) * pixel;
    done += run;
  }
  return at > bytes.size() ? kCutShort : "";
}

}  // namespace

TextureFormat texture_format(std::span<const char> bytes) {
  const std::string_view text(bytes.data(), bytes.size());
  if (text.starts_with(kPngSignature)) return TextureFormat::png;
  if (text.starts_with("\xFF\xD8\xFF")) return TextureFormat::jpeg;
  if (text.starts_with("BM")) return TextureFormat::bmp;
  return is_tga(text) ? TextureFormat::tga : TextureFormat::unknown;
}

std::string texture_fault(std::span<const char> bytes, TextureFormat format) {
  const std::string_view text(bytes.data(), bytes.size());
  switch (format) {
    case TextureFormat::png:
      return png_fault(text);
    case TextureFormat::jpeg:
      return jpeg_fault(text);
    case TextureFormat::bmp:
      return bmp_fault(text);
    case TextureFormat::tga:
      return tga_fault(text);
    case TextureFormat::unknown:
      break;
  }
  return "is not a PNG, JPEG, TGA or BMP image";
}

}  // namespace kerf
