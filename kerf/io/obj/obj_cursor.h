#pragma once

#include <cstddef>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

#include "kerf/base/error.h"

namespace kerf {

/// What is wrong with a text, and where. Thrown while a part of a file is read, where the number of the line is not
/// known, and turned into an Error once.
struct ObjFault {
  const char* at;
  std::string sentence;
};

/// The Error (file) with the place "name:LINE" for a fault in these bytes.
Error obj_error(std::span<const char> bytes, const std::string& name, const ObjFault& fault);

/// The bytes without the mark that some editors put in front of UTF-8. Throws Error (file) where lines end with
/// carriage returns alone: the file would look like a single line.
std::span<const char> obj_text(std::span<const char> bytes, const std::string& name);

/// Walks over the statements of an OBJ or MTL, word by word. A statement is a line, or several where all but the last
/// end with a backslash; a word that begins with '#' begins a comment, which ends with its line. Throws ObjFault.
class ObjCursor {
 public:
  ObjCursor(const char* begin, const char* end) : begin_(begin), position_(begin), end_(end) {}

  /// Goes on to the next statement, from the end of one or the beginning of the text; false at the end of the text.
  bool next_statement() {
    while (ends()) {
      if (position_ == end_) return false;
      if (*position_ == '#') {
        skip_line();
      } else {
        ++position_;
      }
    }
    return true;
  }

  /// Passes over blanks; whether the statement ends here.
  bool ends() {
    while (position_ != end_) {
      if (is_blank(*position_)) {
        ++position_;
      } else if (*position_ == '\\' && after_continuation() != position_) {
        position_ = after_continuation();
      } else {
        return *position_ == '\n' || *position_ == '#';
      }
    }
    return true;
  }

  /// The characters up to the next blank; empty where the statement ends, so ask ends() first.
  std::string_view word() {
    const char* begin = position_;
    while (!word_ends()) ++position_;
    return {begin, position_};
  }

  /// The number that follows; `what` is its name in errors, such as "the x of a vertex".
  float number(std::string_view what);

  /// Fails where anything is left in the statement.
  void expect_end(std::string_view what) {
    if (!ends()) fail_end(what);
  }

  /// What is left of the statement, without the blanks around it, and goes on to its end. A '#' has no meaning in it,
  /// as names of files may have one.
  std::string_view rest();

  /// Passes over what is left of the statement.
  void skip_statement() {
    while (true) {
      const char* line = position_;
      skip_line();
      if (position_ == end_ || !is_continued() || has_comment(line)) return;
      ++position_;
    }
  }

  /// Whether a word that has begun has its last character in front of this place.
  bool word_ends() const {
    if (position_ == end_ || is_blank(*position_) || *position_ == '\n') return true;
    return *position_ == '\\' && after_continuation() != position_;
  }

  const char* position() const { return position_; }
  void move_to(const char* position) { position_ = position; }
  const char* end() const { return end_; }

  /// Throws for the word that begins at `at`: "found 'WORD' where EXPECTED was expected".
  [[noreturn]] void fail_word(const char* at, std::string_view expected);
  /// Throws for a statement that ends too early.
  [[noreturn]] void fail_missing(std::string_view expected) const;

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

  void skip_line() {
    const void* newline = std::memchr(position_, '\n', static_cast<size_t>(end_ - position_));
    position_ = newline == nullptr ? end_ : static_cast<const char*>(newline);
  }

  /// Where a line goes on of which the end is the backslash here; here itself where the line does not.
  const char* after_continuation() const {
    const char* next = position_ + 1;
    if (next != end_ && *next == '\r') ++next;
    return next != end_ && *next == '\n' ? next + 1 : position_;
  }

  /// Whether a backslash stands in front of the end of the line here.
  bool is_continued() const {
    const char* last = position_;
    if (last != begin_ && last[-1] == '\r') --last;
    return last != begin_ && last[-1] == '\\';
  }

  /// Whether a comment stands between `line` and here.
  bool has_comment(const char* line) const;
  [[noreturn]] void fail_end(std::string_view what);

  const char* begin_;
  const char* position_;
  const char* end_;
};

/// A name that goes on over several lines, as one: backslashes at their ends become blanks.
std::string obj_name(std::string_view text);

}  // namespace kerf
