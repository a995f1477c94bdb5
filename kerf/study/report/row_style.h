#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "kerf/study/report/markup.h"

namespace kerf::report {

/// The numbers that rows have in the whole report, from 1, in the order in which they were met.
class RowNumbers {
 public:
  void add(std::string_view row);
  /// Of a row that was added.
  size_t of(std::string_view row) const;
  const std::vector<std::string>& names() const { return names_; }

 private:
  std::vector<std::string> names_;
};

/// The class that colours what belongs to a row: eight colours, told apart by colour-blind readers as well; rows that
/// share one differ in marker.
std::string color_class(size_t number);

/// The dashes of a row's lines, as SVG takes them.
std::string_view dashes(size_t number);

/// Draws a row's marker around a place: a filled or open circle, square, diamond or triangle.
void draw_marker(Markup& out, size_t number, double x, double y, std::string_view what);

/// Writes a pipeline so that lines may end behind its signs, as <code>.
void write_name(Markup& out, std::string_view name);

/// Writes a name so that lines may end behind its low lines.
void write_words(Markup& out, std::string_view name);

/// A row's marker by itself, for a key; with a line through it where `line`.
void write_key_mark(Markup& out, size_t number, bool line);

/// A list of rows: marker, with a line through it where `lines`, number and name.
void write_key(Markup& out, const std::vector<size_t>& numbers, const std::vector<std::string>& names, bool lines);

}  // namespace kerf::report
