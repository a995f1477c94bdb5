#include "kerf/io/obj/obj_cursor.h"

#include <fmt/format.h>

#include <algorithm>

#include "kerf/io/message.h"
#include "kerf/io/text_number.h"

namespace kerf {

Error obj_error(std::span<const char> bytes, const std::string& name, const ObjFault& fault) {
  const auto line = 1 + std::count(bytes.data(), fault.at, '\n');
  return {ErrorCode::file, fmt::format("{}:{}", name, line), fault.sentence};
}

std::span<const char> obj_text(std::span<const char> bytes, const std::string& name) {
  if (std::string_view(bytes.data(), std::min<size_t>(bytes.size(), 3)) == "\xEF\xBB\xBF") bytes = bytes.subspan(3);
  const std::string_view text(bytes.data(), bytes.size());
  const size_t first = text.find('\n') == text.npos ? text.find('\r') : text.npos;
  if (first != text.npos && text.find_first_not_of("\r \t", first) != text.npos) {
    throw Error(ErrorCode::file, name + ":1", "lines end with a carriage return alone; line feeds are expected");
  }
  return bytes;
}

float ObjCursor::number(std::string_view what) {
  if (ends()) fail_missing(what);
  float value = 0;
  const char* begin = position_;
  const char* after = parse_float(begin, end_, value);
  if (after == nullptr) fail_word(begin, what);
  position_ = after;
  if (!word_ends()) fail_word(begin, what);
  return value;
}

std::string_view ObjCursor::rest() {
  ends();  // for the blanks in front
  const char* begin = position_;
  skip_statement();
  std::string_view text(begin, position_);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

bool ObjCursor::has_comment(const char* line) const {
  for (const char* p = line; p != position_; ++p) {
    if (*p == '#' && (p == line || is_blank(p[-1]))) return true;
  }
  return false;
}

void ObjCursor::fail_word(const char* at, std::string_view expected) {
  position_ = at;
  const std::string found = quoted(word());
  throw ObjFault{at, fmt::format("found {} where {} was expected", found, expected)};
}

void ObjCursor::fail_missing(std::string_view expected) const {
  throw ObjFault{position_, fmt::format("the line ends where {} was expected", expected)};
}

void ObjCursor::fail_end(std::string_view what) {
  const char* at = position_;
  const std::string found = quoted(word());
  throw ObjFault{at, fmt::format("found {} behind {}", found, what)};
}

std::string obj_name(std::string_view text) {
  std::string name;
  for (size_t i = 0; i < text.size(); ++i) {
    const size_t newline = text.substr(i).starts_with("\\\n")     ? i + 1
                           : text.substr(i).starts_with("\\\r\n") ? i + 2
                                                                  : 0;
    name += newline == 0 ? text[i] : ' ';
    if (newline != 0) i = newline;
  }
  return name;
}

}  // namespace kerf
