#include "kerf/study/report/markup.h"

#include <algorithm>
#include <cassert>
#include <cstdint>

namespace kerf::report {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";
constexpr std::string_view kEllipsis = "\xE2\x80\xA6";

/// A character of a text; not valid: the one byte is none.
struct Character {
  uint32_t code = 0;
  size_t length = 1;
  bool valid = false;
};

bool is_allowed(uint32_t code) {
  if (code < 0x20) return code == '\t' || code == '\n' || code == '\r';
  return !(0x7F <= code && code <= 0x9F) && !(0xD800 <= code && code <= 0xDFFF) && code <= 0x10FFFF &&
         (code & 0xFFFE) != 0xFFFE;
}

Character first_character(std::string_view text) {
  const auto byte = [&](size_t i) { return static_cast<uint32_t>(static_cast<unsigned char>(text[i])); };
  constexpr uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};  // of a length: shorter forms are the right ones
  const uint32_t lead = byte(0);
  if (lead < 0x80) return {lead, 1, is_allowed(lead)};
  size_t length = 0;
  uint32_t code = 0;
  if (lead >> 5 == 0x6) {
    length = 2;
    code = lead & 0x1F;
  } else if (lead >> 4 == 0xE) {
    length = 3;
    code = lead & 0x0F;
  } else if (lead >> 3 == 0x1E) {
    length = 4;
    code = lead & 0x07;
  }
  if (length == 0 || text.size() < length) return {};
  for (size_t i = 1; i < length; ++i) {
    if (byte(i) >> 6 != 0x2) return {};
    code = code << 6 | (byte(i) & 0x3F);
  }
  if (code < kLeast[length] || !is_allowed(code)) return {};
  return {code, length, true};
}

size_t columns_of(uint32_t code) {
  const bool wide = (0x1100 <= code && code <= 0x115F) || (0x2E80 <= code && code <= 0xA4CF) ||
                    (0xAC00 <= code && code <= 0xD7A3) || (0xF900 <= code && code <= 0xFAFF) ||
                    (0xFE30 <= code && code <= 0xFE6F) || (0xFF00 <= code && code <= 0xFF60) || code >= 0x1F000;
  return wide ? 2 : 1;
}

/// The longest beginning that is no wider than `columns` and ends, where it can, behind a place to break.
size_t line_length(std::string_view text, size_t columns) {
  size_t used = 0, length = 0, at_break = 0;
  while (length < text.size()) {
    const Character c = first_character(text.substr(length));
    used += columns_of(c.code);
    if (used > columns && length > 0) return at_break > 0 ? at_break : length;
    length += c.length;
    if (c.code == '+' || c.code == ',' || c.code == ' ') at_break = length;
  }
  return length;
}

}  // namespace

std::string valid_text(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const Character c = first_character(text);
    out += c.valid ? text.substr(0, c.length) : kReplacement;
    text.remove_prefix(c.length);
  }
  return out;
}

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : valid_text(text)) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

size_t text_columns(std::string_view text) {
  size_t columns = 0;
  while (!text.empty()) {
    const Character c = first_character(text);
    columns += columns_of(c.code);
    text.remove_prefix(c.length);
  }
  return columns;
}

std::vector<std::string> wrapped(std::string_view name, size_t columns, size_t most_lines) {
  const std::string valid = valid_text(name);
  std::string_view rest = valid;
  std::vector<std::string> lines;
  while (lines.size() + 1 < most_lines) {
    const size_t length = line_length(rest, columns);
    if (length == rest.size()) break;
    lines.emplace_back(rest.substr(0, length));
    rest.remove_prefix(length);
  }
  const bool fits = text_columns(rest) <= columns;
  lines.emplace_back(fits ? rest : rest.substr(0, line_length(rest, columns - 1)));
  if (!fits) lines.back() += kEllipsis;
  return lines;
}

std::string base64(const std::vector<unsigned char>& bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    const size_t count = std::min<size_t>(3, bytes.size() - i);
    uint32_t word = 0;
    for (size_t k = 0; k < 3; ++k) word = word << 8 | (k < count ? bytes[i + k] : 0U);
    for (size_t k = 0; k < 4; ++k) out += k <= count ? kDigits[word >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

void Markup::begin(std::string_view tag, Attributes attributes) {
  out_ += '<';
  out_ += tag;
  for (const auto& [name, value] : attributes) {
    out_ += ' ';
    out_ += name;
    out_ += "=\"";
    out_ += escaped(value);
    out_ += '"';
  }
}

void Markup::open(std::string_view tag, Attributes attributes) {
  begin(tag, attributes);
  out_ += '>';
  open_.emplace_back(tag);
}

void Markup::close() {
  assert(!open_.empty());
  out_ += "</";
  out_ += open_.back();
  out_ += '>';
  open_.pop_back();
}

void Markup::leaf(std::string_view tag, Attributes attributes) {
  begin(tag, attributes);
  out_ += "/>";
}

void Markup::element(std::string_view tag, Attributes attributes, std::string_view text_inside) {
  open(tag, attributes);
  text(text_inside);
  close();
}

std::string Markup::take() {
  assert(open_.empty());
  return std::move(out_);
}

}  // namespace kerf::report
