#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "kerf/io/ply/ply_header.h"

namespace kerf {

// Two cursors with the same face walk over the body of a PLY, value by value in the order of the header, one for each
// way of writing numbers. Neither believes the file: whatever is wrong, or missing, is an Error (file).

/// Walks over the body of a binary PLY. Errors have the place "name, byte OFFSET".
class PlyBinaryCursor {
 public:
  PlyBinaryCursor(std::span<const char> bytes, const PlyHeader& header, const std::string& name);

  /// Starts an element and checks that what is left of the file has room for all its rows.
  void begin(const PlyElement& element);
  void begin_row(uint64_t row) { row_ = row; }
  void end_row() {}

  double real(const PlyProperty& property);
  /// A float that is not whole is an error.
  int64_t integer(const PlyProperty& property);
  /// The number that stands before a list.
  uint64_t list_count(const PlyProperty& property);
  /// Steps over a value, or over a list with its count.
  void skip(const PlyProperty& property);
  /// Steps over all rows of the element at once where they have one size; false where they have not.
  bool skip_rows();

  /// An upper bound for the rows that follow where each has at least the values of a triangle in its list.
  uint64_t most_triangle_rows(const PlyProperty& list) const;

  /// Throws for the value read last: "ELEMENT ROW SENTENCE".
  [[noreturn]] void fail(const std::string& sentence) const;

  // What the fast paths need, which read whole rows of one size.
  std::span<const char> rest() const { return {position_, end_}; }
  void advance(size_t bytes) { position_ += bytes; }
  bool swap() const { return swap_; }

 private:
  const char* take(size_t bytes);
  double number(PlyType type);
  int64_t whole(PlyType type);
  [[noreturn]] void fail_at(const char* at, const std::string& sentence) const;

  const char* start_;
  const char* position_;
  const char* end_;
  const char* value_;  // read last: the place of errors
  bool swap_;
  const std::string& name_;
  const PlyElement* element_ = nullptr;
  size_t row_size_ = 0;  // the least that a row takes
  uint64_t row_ = 0;
};

/// Walks over the body of an ascii PLY: each row stands on a line of its own, blank lines between them are passed
/// over. Errors have the place "name:LINE".
class PlyAsciiCursor {
 public:
  PlyAsciiCursor(std::span<const char> bytes, const PlyHeader& header, const std::string& name);

  /// Starts an element and checks that what is left of the file has room for all its rows.
  void begin(const PlyElement& element);
  void begin_row(uint64_t row);
  /// Fails where values are left on the line.
  void end_row();

  double real(const PlyProperty& property);
  int64_t integer(const PlyProperty& property);
  uint64_t list_count(const PlyProperty& property);
  void skip(const PlyProperty& property);
  bool skip_rows() { return false; }

  uint64_t most_triangle_rows(const PlyProperty& list) const;

  [[noreturn]] void fail(const std::string& sentence) const;

 private:
  std::string_view token(const PlyProperty& property);
  template <class T>
  T parse(std::string_view text, const PlyProperty& property) const;
  double number(PlyType type, const PlyProperty& property);
  int64_t whole(PlyType type, const PlyProperty& property);
  [[noreturn]] void fail_here(const std::string& sentence) const;

  const char* position_;
  const char* end_;
  size_t line_;
  const std::string& name_;
  const PlyElement* element_ = nullptr;
  size_t row_size_ = 0;
  uint64_t row_ = 0;
};

}  // namespace kerf
