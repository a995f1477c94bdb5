#include "kerf/io/texture/jpeg_check.h"

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace kerf {
namespace {

constexpr const char* kCutShort = "is cut short";

/// The markers that matter here.
enum Marker : uint8_t {
  kBaseline = 0xC0,
  kExtended = 0xC1,
  kProgressive = 0xC2,
  kHuffmanTables = 0xC4,
  kEndOfImage = 0xD9,
  kScan = 0xDA,
  kQuantizationTables = 0xDB
};

struct Component {
  uint8_t id, quantization_table;
  bool has_pixels = false;
};

class JpegWalk {
 public:
  explicit JpegWalk(std::string_view bytes) : bytes_(bytes) {}

  std::string fault() {
    size_t at = next_marker(2);
    while (bytes_.size() - at >= 2) {
      const uint8_t marker = byte(bytes_, at + 1);
      if (marker == kEndOfImage) return end_fault();
      if (bytes_.size() - at < 4) break;
      const size_t size = big16(bytes_, at + 2);
      if (size < 2) return fmt::format("is damaged: the segment at byte {} has no size", at);
      if (size > bytes_.size() - at - 2) break;
      if (std::string fault = segment_fault(marker, bytes_.substr(at + 4, size - 2)); !fault.empty()) return fault;
      at = next_marker(at + 2 + size);
    }
    return kCutShort;
  }

 private:
  static uint8_t byte(std::string_view data, size_t at) { return static_cast<uint8_t>(data[at]); }
  static size_t big16(std::string_view data, size_t at) {
    return static_cast<size_t>(byte(data, at)) << 8 | byte(data, at + 1);
  }

  /// Where the next marker begins, at `at` or behind padding or packed pixels; the end where there is none.
  size_t next_marker(size_t at) const {
    for (; at + 1 < bytes_.size(); ++at) {
      const uint8_t next = byte(bytes_, at + 1);
      const bool is_restart = 0xD0 <= next && next <= 0xD7;
      if (byte(bytes_, at) == 0xFF && next != 0 && next != 0xFF && !is_restart) return at;
    }
    return bytes_.size();
  }

  std::string segment_fault(uint8_t marker, std::string_view data) {
    switch (marker) {
      case kBaseline:
      case kExtended:
      case kProgressive:
        is_progressive_ = marker == kProgressive;
        return frame_fault(data);
      case kHuffmanTables:
        return huffman_fault(data);
      case kQuantizationTables:
        return quantization_fault(data);
      case kScan:
        return scan_fault(data);
      default:
        return {};
    }
  }

  std::string frame_fault(std::string_view data) {
    constexpr size_t kMostPacking = 1024;  // a bit for a block of 8 x 8 pixels, in each of few passes
    if (!components_.empty()) return "is damaged: it has two frames";
    if (data.size() < 6 || data.size() != 6 + 3 * size_t{byte(data, 5)})
      return "is damaged: its frame has a wrong size";
    if (big16(data, 1) * big16(data, 3) / kMostPacking > bytes_.size()) {
      return "has fewer bytes than so many pixels can be packed into";
    }
    for (size_t at = 6; at < data.size(); at += 3) components_.push_back({byte(data, at), byte(data, at + 2)});
    return {};
  }

  std::string huffman_fault(std::string_view data) {
    const char* const damaged = "is damaged: a Huffman table is none";
    while (!data.empty()) {
      if (data.size() < 17) return damaged;
      const uint8_t kind = byte(data, 0) >> 4, number = byte(data, 0) & 15;
      size_t codes = 0;
      for (size_t i = 1; i <= 16; ++i) codes += byte(data, i);
      if (kind > 1 || number > 3 || codes > 256 || data.size() < 17 + codes) return damaged;
      huffman_tables_[kind] |= 1U << number;
      data.remove_prefix(17 + codes);
    }
    return {};
  }

  std::string quantization_fault(std::string_view data) {
    while (!data.empty()) {
      const uint8_t is_wide = byte(data, 0) >> 4, number = byte(data, 0) & 15;
      const size_t size = 1 + size_t{64} * (is_wide + 1U);
      if (is_wide > 1 || number > 3 || data.size() < size) return "is damaged: a quantization table is none";
      quantization_tables_ |= 1U << number;
      data.remove_prefix(size);
    }
    return {};
  }

  Component* find(uint8_t id) {
    for (Component& component : components_) {
      if (component.id == id) return &component;
    }
    return nullptr;
  }

  std::string scan_fault(std::string_view data) {
    const size_t count = data.empty() ? 0 : byte(data, 0);
    if (data.size() != 4 + 2 * count) return "is damaged: a scan has a wrong size";
    const bool is_first_value = byte(data, 1 + 2 * count) == 0;  // of each block: DC; else AC
    const bool is_refinement = byte(data, 3 + 2 * count) >> 4 != 0;
    for (size_t i = 0; i < count; ++i) {
      Component* component = find(byte(data, 1 + 2 * i));
      if (component == nullptr) return "is damaged: a scan is of a colour that the image has not";
      const uint8_t tables = byte(data, 2 + 2 * i);
      const bool needs_dc = !is_progressive_ || (is_first_value && !is_refinement);
      const bool needs_ac = !is_progressive_ || !is_first_value;
      if ((needs_dc && !has(huffman_tables_[0], tables >> 4)) || (needs_ac && !has(huffman_tables_[1], tables & 15)) ||
          !has(quantization_tables_, component->quantization_table)) {
        return "is damaged: a table is missing";
      }
      if (needs_dc) component->has_pixels = true;
      if (!component->has_pixels) return "is damaged: a scan refines a colour that has no pixels yet";
    }
    return {};
  }

  std::string end_fault() const {
    if (components_.empty()) return "is damaged: it has no frame";
    for (const Component& component : components_) {
      if (!component.has_pixels) return "is damaged: a colour has no pixels";
    }
    return {};
  }

  static bool has(uint32_t tables, uint32_t number) { return number < 4 && (tables >> number & 1U) != 0; }

  std::string_view bytes_;
  bool is_progressive_ = false;
  std::vector<Component> components_;
  uint32_t huffman_tables_[2] = {0, 0};  // of DC and AC: which are there, as bits
  uint32_t quantization_tables_ = 0;
};

}  // namespace

std::string jpeg_fault(std::string_view bytes) { return JpegWalk(bytes).fault(); }

}  // namespace kerf
