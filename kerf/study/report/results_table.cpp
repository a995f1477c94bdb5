#include "kerf/study/report/results_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "kerf/study/report/columns.h"
#include "kerf/study/report/number_text.h"

namespace kerf::report {
namespace {

constexpr std::string_view kDash = "\xE2\x80\x93";

/// How a column is shown in one table.
struct Shown {
  const Column* column;
  Unit unit;
  std::string best;  ///< the text of its best value; empty: none is
};

/// The text of the best value above zero, so that values which look the same are all bold; none where all look the
/// same.
std::string best_text(const Column& column, const Unit& unit, std::span<const StudyResult* const> results) {
  if (column.best == Best::none) return "";
  std::optional<double> best;
  for (const StudyResult* result : results) {
    const double value = result->finished ? column.value(*result) : 0;
    if (!(value > 0) || std::isinf(value)) continue;
    if (!best || (column.best == Best::least ? value < *best : value > *best)) best = value;
  }
  if (!best) return "";
  const std::string text = value_text(column, *best, unit);
  const bool differ = std::any_of(results.begin(), results.end(), [&](const StudyResult* result) {
    return result->finished && value_text(column, column.value(*result), unit) != text;
  });
  return differ ? text : "";
}

void write_symbol(Markup& out, const Column& column) {
  out.open("span", {{"class", column.symbol.size() == 1 ? "symbol" : "symbol upright"}});
  out.text(column.symbol);
  if (!column.lowered.empty()) out.element("sub", column.lowered);
  out.close();
}

void write_head(Markup& out, const std::vector<Shown>& shown, TableRows rows) {
  out.open("thead");
  out.open("tr");
  const auto head = [&](std::string_view text, std::string_view words) {
    out.open("th", {{"scope", "col"}});
    out.element("span", {{"class", "symbol upright"}}, text);
    out.element("span", {{"class", "words"}}, words);
    out.close();
  };
  if (rows == TableRows::limits) {
    head("sa_max", "limit of area");
  } else {
    head("Row", "pipeline");
  }
  if (rows == TableRows::scenes) head("Triangles", "of the scene");
  for (const auto& [column, unit, best] : shown) {
    out.open("th", {{"scope", "col"}, {"title", column->sentence}});
    write_symbol(out, *column);
    out.element("span", {{"class", "words"}}, column->words);
    if (!unit.name.empty()) out.element("span", {{"class", "unit"}}, unit.name);
    out.close();
  }
  out.close();
  out.close();
  out.line();
}

void write_cell(Markup& out, const StudyResult& result, const Shown& shown) {
  const auto& [column, unit, best] = shown;
  const double value = column->value(result);
  if (std::isnan(value) && column->id == "overlap" && !result.end_point_overlap) {
    out.element("td", {{"data-v", "NaN"}, {"class", "none"}}, kDash);
    return;
  }
  const std::string text = value_text(*column, value, unit);
  out.open("td", {{"data-v", script_number(value)}});
  out.element(!best.empty() && text == best ? "strong" : "span", text);
  const Spread* spread = column->spread != nullptr ? column->spread(result) : nullptr;
  if (spread != nullptr && spread->count > 1) {
    out.element("span", {{"class", "range"}},
                fmt::format("{}\xE2\x80\x89{}\xE2\x80\x89{}", value_text(*column, spread->least, unit), kDash,
                            value_text(*column, spread->most, unit)));
  }
  const double paper = result.paper && column->paper != nullptr ? column->paper(*result.paper) : NAN;
  if (std::isfinite(paper)) {
    out.open("span", {{"class", "paper"}});
    out.text("paper " + value_text(*column, paper, unit));
    if (paper > 0 && std::isfinite(value)) {
      out.element("span", {{"class", "ratio"}}, fmt::format("ours {}\xC3\x97", number_text(value / paper)));
    }
    out.close();
  }
  out.close();
}

void write_row_head(Markup& out, const StudyResult& result, size_t number, TableRows rows) {
  if (rows == TableRows::limits) {
    out.element("th", {{"scope", "row"}, {"data-v", script_number(result.sa_max)}},
                std::isnan(result.sa_max) ? "auto" : chosen_text(result.sa_max));
    return;
  }
  out.open("th", {{"scope", "row"}, {"data-v", std::to_string(number)}});
  out.element("b", {{"class", "number"}}, std::to_string(number));
  out.text(" ");
  write_name(out, result.row);
  out.close();
  if (rows == TableRows::scenes) {
    out.open("td", {{"data-v", std::to_string(result.triangles)}});
    out.element("span", count_text(result.triangles));
    out.element("span", {{"class", "range"}}, result.scene);
    out.close();
  }
}

void write_row(Markup& out, const StudyResult& result, size_t number, TableRows rows, const std::vector<Shown>& shown) {
  if (rows == TableRows::limits) {
    out.open("tr");
  } else {
    out.open("tr", {{"data-row", std::to_string(number)}});
  }
  write_row_head(out, result, number, rows);
  if (result.finished) {
    for (const Shown& s : shown) write_cell(out, result, s);
  } else {
    out.open("td", {{"class", "unfinished"}, {"colspan", std::to_string(shown.size())}});
    out.element("b", "not finished");
    if (!result.why_not.empty()) out.text(": " + result.why_not);
    out.close();
  }
  out.close();
  out.line();
}

void write_definition(Markup& out, std::string_view term, std::string_view sentence) {
  out.open("div");
  out.element("dt", term);
  out.element("dd", sentence);
  out.close();
  out.line();
}

}  // namespace

void write_table(Markup& out, std::span<const StudyResult* const> results, const RowNumbers& numbers, TableRows rows,
                 std::string_view caption) {
  std::vector<Shown> shown;
  for (const Column& column : columns()) {
    const Unit unit = column_unit(column, results);
    shown.push_back({&column, unit, rows == TableRows::pipelines ? best_text(column, unit, results) : ""});
  }
  out.open("div", {{"class", "scroll"}, {"tabindex", "0"}, {"role", "region"}, {"aria-label", caption}});
  out.open("table", {{"class", rows == TableRows::limits ? "results limits" : "results"}});
  out.element("caption", caption);
  write_head(out, shown, rows);
  out.open("tbody");
  out.line();
  for (const StudyResult* result : results) {
    write_row(out, *result, rows == TableRows::limits ? 0 : numbers.of(result->row), rows, shown);
  }
  out.close();
  out.close();
  out.close();
  out.line();
}

void write_legend(Markup& out) {
  out.open("section", {{"id", "legend"}});
  out.element("h2", "What the columns mean");
  out.open("dl", {{"class", "legend"}});
  for (const Column& column : columns()) {
    out.open("div");
    out.open("dt");
    write_symbol(out, column);
    out.element("span", {{"class", "words"}}, column.words);
    out.close();
    out.element("dd", column.sentence);
    out.close();
    out.line();
  }
  write_definition(out, "Row", "A pipeline: all that is done to make the structure, in order, joined by +.");
  write_definition(out, "sa_max",
                   "The limit of early split clipping: boxes of references with a larger surface area (all six faces, "
                   "squared units of the scene) are split. \xE2\x88\x9E: none is.");
  write_definition(out, "Small figures under a time",
                   "The shortest and the longest of its repeated runs. The figure is "
                   "their median.");
  write_definition(out, "paper",
                   "What the paper printed for this row, and how many times that ours is. Counts and "
                   "ratios can be compared; its times are of a computer of 2007.");
  write_definition(out, "Bold", "The best of its column.");
  write_definition(out, "Not finished",
                   "The row reached a limit of time or memory, or could not be made. It says which.");
  out.close();
  out.element("h3", "Sources");
  out.open("ul", {{"class", "sources"}});
  out.element("li",
              "Manfred Ernst, G\xC3\xBCnther Greiner: Early Split Clipping for Bounding Volume Hierarchies. IEEE "
              "Symposium on Interactive Ray Tracing, 2007. The columns R to S are those of its Table 1.");
  out.element("li",
              "Timo Aila, Tero Karras, Samuli Laine: On Quality Metrics of Bounding Volume Hierarchies. High "
              "Performance Graphics, 2013. End-point overlap.");
  out.close();
  out.close();
  out.line();
}

}  // namespace kerf::report
