#include "kerf/io/ply/ply_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <set>

#include "kerf/base/error.h"
#include "kerf/base/nearest_word.h"
#include "kerf/io/message.h"

namespace kerf {
namespace {

// Each type by its two names, in the order of PlyType.
constexpr std::string_view kTypeNames[] = {"char", "int8",  "uchar", "uint8",  "short", "int16",   "ushort", "uint16",
                                           "int",  "int32", "uint",  "uint32", "float", "float32", "double", "float64"};
constexpr std::string_view kFormatNames[] = {"ascii", "binary_little_endian", "binary_big_endian"};
constexpr std::string_view kKeywords[] = {"format", "comment", "obj_info", "element", "property", "end_header"};

template <size_t N>
std::optional<size_t> position_in(const std::string_view (&menu)[N], std::string_view word) {
  const auto* found = std::find(menu, menu + N, word);
  if (found == menu + N) return std::nullopt;
  return static_cast<size_t>(found - menu);
}

/// The words of one line; no line of a header has more than five that count, so a sixth stands for all the rest.
struct Words {
  std::array<std::string_view, 6> word;
  size_t count = 0;

  explicit Words(std::string_view line) {
    constexpr std::string_view kBlanks = " \t\r\v\f";
    for (size_t begin = line.find_first_not_of(kBlanks); begin != line.npos && count < word.size();) {
      const size_t end = std::min(line.find_first_of(kBlanks, begin), line.size());
      word[count++] = line.substr(begin, end - begin);
      begin = line.find_first_not_of(kBlanks, end);
    }
  }
};

class HeaderParser {
 public:
  HeaderParser(std::span<const char> bytes, const std::string& name) : rest_(bytes.data(), bytes.size()), name_(name) {}

  PlyHeader parse() {
    const size_t size = rest_.size();
    read_magic();
    for (bool more = true; more;) {
      if (!next_line()) {
        fail("the file ends in the header: there is no line end_header");
      }
      more = read_line();
    }
    if (!has_format_) {
      fail(
          "the header has no format line; expected 'format ascii 1.0', 'format binary_little_endian 1.0' or "
          "'format binary_big_endian 1.0'");
    }
    header_.size = size - rest_.size();
    return std::move(header_);
  }

 private:
  [[noreturn]] void fail(const std::string& sentence) const {
    throw Error(ErrorCode::file, fmt::format("{}:{}", name_, std::max<size_t>(header_.lines, 1)), sentence);
  }

  bool next_line() {
    if (rest_.empty()) return false;
    const size_t end = std::min(rest_.find('\n'), rest_.size());
    line_ = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    ++header_.lines;
    return true;
  }

  void read_magic() {
    if (!next_line()) fail("is not a PLY: the file is empty");
    if (line_.starts_with("ply\r") && line_.size() > 4) {
      fail("lines end with a carriage return alone; a PLY needs line feeds");
    }
    const Words words(line_);
    if (words.count != 1 || words.word[0] != "ply" || !line_.starts_with("ply")) {
      fail(fmt::format("is not a PLY: found {} where the first line must be 'ply'", quoted(line_)));
    }
  }

  /// False at end_header.
  bool read_line() {
    const Words words(line_);
    if (words.count == 0) return true;
    const std::string_view keyword = words.word[0];
    if (keyword == "comment" || keyword == "obj_info") return true;
    if (keyword == "end_header") {
      if (words.count > 1) fail(fmt::format("found {} after end_header", quoted(words.word[1])));
      return false;
    }
    if (keyword == "format") {
      read_format(words);
    } else if (keyword == "element") {
      read_element(words);
    } else if (keyword == "property") {
      read_property(words);
    } else {
      fail(fmt::format("unknown word {} in the header", quoted(keyword)) + suggestion(keyword, kKeywords));
    }
    return true;
  }

  void read_format(const Words& words) {
    if (has_format_) fail("the header has a second format line");
    if (words.count != 3) fail(fmt::format("found {}; expected 'format NAME 1.0'", quoted(line_)));
    const auto format = position_in(kFormatNames, words.word[1]);
    if (!format) {
      fail(fmt::format("unknown format {}", quoted(words.word[1])) + suggestion(words.word[1], kFormatNames));
    }
    if (words.word[2] != "1.0") {
      fail(fmt::format("unknown version {} of the format; expected 1.0", quoted(words.word[2])));
    }
    header_.format = static_cast<PlyFormat>(*format);
    has_format_ = true;
  }

  void read_element(const Words& words) {
    if (words.count != 3) fail(fmt::format("found {}; expected 'element NAME COUNT'", quoted(line_)));
    PlyElement element{.name = words.word[1], .line = header_.lines};
    const std::string_view count = words.word[2];
    const auto [end, error] = std::from_chars(count.data(), count.data() + count.size(), element.count);
    if (error != std::errc{} || end != count.data() + count.size()) {
      fail(fmt::format("element {} has the count {}; expected a whole number from 0 to 2^64 - 1",
                       printable(element.name), quoted(count)));
    }
    if (!element_names_.insert(element.name).second) {
      fail(fmt::format("a second element {}", quoted(element.name)));
    }
    property_names_.clear();
    header_.elements.push_back(std::move(element));
  }

  void read_property(const Words& words) {
    const bool is_list = words.count > 1 && words.word[1] == "list";
    if (words.count != (is_list ? 5 : 3)) {
      fail(fmt::format("found {}; expected 'property TYPE NAME' or 'property list TYPE TYPE NAME'", quoted(line_)));
    }
    if (header_.elements.empty()) fail("a property before the first element");
    PlyProperty property{.name = words.word[words.count - 1], .type = read_type(words.word[words.count - 2])};
    if (is_list) property.count_type = read_type(words.word[2]);
    if (!property_names_.insert(property.name).second) {
      fail(fmt::format("a second property {} in element {}", quoted(property.name),
                       printable(header_.elements.back().name)));
    }
    header_.elements.back().properties.push_back(property);
  }

  PlyType read_type(std::string_view word) const {
    if (const auto found = position_in(kTypeNames, word)) return static_cast<PlyType>(*found / 2);
    // The nearest word to int64 would be int8, which is no help.
    if (word.ends_with("64") || word == "long" || word == "ulong") {
      fail(fmt::format("type {} is not part of PLY 1.0: its integers have at most 32 bits", quoted(word)));
    }
    fail(fmt::format("unknown type {}", quoted(word)) + suggestion(word, kTypeNames));
  }

  std::string_view rest_;
  const std::string& name_;
  std::string_view line_;
  bool has_format_ = false;
  std::set<std::string_view> element_names_;   // sets, so that a header of a million names takes no hours
  std::set<std::string_view> property_names_;  // of the last element
  PlyHeader header_;
};

}  // namespace

PlyHeader parse_ply_header(std::span<const char> bytes, const std::string& name) {
  return HeaderParser(bytes, name).parse();
}

}  // namespace kerf
