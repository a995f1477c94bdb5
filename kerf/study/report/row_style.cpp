#include "kerf/study/report/row_style.h"

#include <fmt/format.h>

#include <algorithm>

#include "kerf/study/report/number_text.h"

namespace kerf::report {
namespace {

constexpr size_t kColors = 8;

/// The corners of a marker with a radius of about 4.5, as a path around (0, 0).
constexpr std::string_view kShapes[] = {
    "M-4.5 0A4.5 4.5 0 1 0 4.5 0A4.5 4.5 0 1 0 -4.5 0Z",  // circle
    "M-4 -4H4V4H-4Z",                                     // square
    "M0 -5.6L5.6 0L0 5.6L-5.6 0Z",                        // diamond
    "M0 -5.2L5 3.8H-5Z",                                  // triangle
    "M0 5.2L5 -3.8H-5Z",                                  // triangle on its point
    "M-5.2 0L3.8 -5V5Z",                                  // to the left
    "M5.2 0L-3.8 -5V5Z",                                  // to the right
};
constexpr std::string_view kDashes[] = {"none", "7 3", "2 3", "8 3 2 3", "12 4"};

/// Writes a text; write_break() is called behind each of its signs and low lines.
template <class F>
void write_with_breaks(Markup& out, std::string_view name, F&& write_break) {
  constexpr std::string_view kSigns = "+,(_";
  const std::string valid = valid_text(name);
  size_t begin = 0;
  for (size_t i = 0; i < valid.size(); ++i) {
    if (kSigns.find(valid[i]) == std::string_view::npos) continue;
    out.text(std::string_view(valid).substr(begin, i + 1 - begin));
    write_break(valid[i]);
    begin = i + 1;
  }
  out.text(std::string_view(valid).substr(begin));
}

}  // namespace

void RowNumbers::add(std::string_view row) {
  if (std::find(names_.begin(), names_.end(), row) == names_.end()) names_.emplace_back(row);
}

size_t RowNumbers::of(std::string_view row) const {
  return static_cast<size_t>(std::find(names_.begin(), names_.end(), row) - names_.begin()) + 1;
}

std::string color_class(size_t number) { return fmt::format("c{}", (number - 1) % kColors); }

std::string_view dashes(size_t number) { return kDashes[(number - 1) % std::size(kDashes)]; }

void draw_marker(Markup& out, size_t number, double x, double y, std::string_view what) {
  const bool open = (number - 1) / kColors % 2 == 1;
  out.open("path", {{"class", open ? "marker open" : "marker"},
                    {"d", kShapes[(number - 1) % std::size(kShapes)]},
                    {"transform", fmt::format("translate({} {})", place_text(x), place_text(y))}});
  if (!what.empty()) out.element("title", what);
  out.close();
}

void write_name(Markup& out, std::string_view name) {
  out.open("code");
  // Behind a parenthesis only where there is little room.
  write_with_breaks(out, name, [&](char c) {
    if (c == '+' || c == ',') out.leaf("wbr");
    if (c == '(') out.leaf("wbr", {{"class", "narrow"}});
  });
  out.close();
}

void write_words(Markup& out, std::string_view name) {
  write_with_breaks(out, name, [&](char c) {
    if (c == '_') out.leaf("wbr");
  });
}

void write_key_mark(Markup& out, size_t number, bool line) {
  out.open("svg", {{"viewBox", "0 0 34 14"}, {"width", "34"}, {"height", "14"}, {"aria-hidden", "true"}});
  out.open("g", {{"class", color_class(number)}});
  if (line) out.leaf("path", {{"class", "line"}, {"d", "M1 7H33"}, {"stroke-dasharray", dashes(number)}});
  draw_marker(out, number, 17, 7, {});
  out.close();
  out.close();
}

void write_key(Markup& out, const std::vector<size_t>& numbers, const std::vector<std::string>& names, bool lines) {
  out.open("ul", {{"class", "key"}});
  for (const size_t number : numbers) {
    out.open("li", {{"data-row", std::to_string(number)}});
    write_key_mark(out, number, lines);
    out.element("b", std::to_string(number));
    out.text(" ");
    write_name(out, names[number - 1]);
    out.close();
  }
  out.close();
  out.line();
}

}  // namespace kerf::report
