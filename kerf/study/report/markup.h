#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace kerf::report {

/// The text as UTF-8 that XML allows: what is no such character becomes U+FFFD.
std::string valid_text(std::string_view text);

/// The text as it can stand in an element or between double quotes.
std::string escaped(std::string_view text);

/// How wide the text is in characters of a fixed width: two for those of East Asian scripts, one for others.
size_t text_columns(std::string_view text);

/// Cuts a name into lines of at most `columns`, where it can behind one of "+, ". What is longer than `most_lines`
/// ends with "…". At least one line; `columns` and `most_lines` are at least 2 and 1.
std::vector<std::string> wrapped(std::string_view name, size_t columns, size_t most_lines);

/// Bytes as base64, padded.
std::string base64(const std::vector<unsigned char>& bytes);

/// Writes elements so that the page is both HTML and well-formed XML: every element is closed, in order, all text and
/// all values of attributes are escaped.
class Markup {
 public:
  using Attributes = std::initializer_list<std::pair<std::string_view, std::string_view>>;

  void open(std::string_view tag, Attributes attributes = {});
  void close();
  /// An element that has no content: `<br/>` or one of SVG.
  void leaf(std::string_view tag, Attributes attributes = {});
  void text(std::string_view text) { out_ += escaped(text); }
  /// An element that holds nothing but text.
  void element(std::string_view tag, Attributes attributes, std::string_view text);
  void element(std::string_view tag, std::string_view text) { element(tag, {}, text); }
  /// What is markup already.
  void raw(std::string_view markup) { out_ += markup; }
  void line() { out_ += '\n'; }

  /// What was written; all elements have been closed.
  std::string take();

 private:
  void begin(std::string_view tag, Attributes attributes);

  std::string out_;
  std::vector<std::string> open_;
};

}  // namespace kerf::report
