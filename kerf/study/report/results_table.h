#pragma once

#include <span>
#include <string_view>

#include "kerf/study/report/markup.h"
#include "kerf/study/report/row_style.h"
#include "kerf/study/study.h"

namespace kerf::report {

/// What the first column of a table names.
enum class TableRows {
  pipelines,  ///< the row and its number
  limits,     ///< sa_max
  scenes,     ///< the row, its number, the scene and its triangles
};

/// A table of every column: a line for each result, with spreads and what a paper printed under its numbers. The best
/// of a column is bold where several finished, except among limits.
void write_table(Markup& out, std::span<const StudyResult* const> results, const RowNumbers& numbers, TableRows rows,
                 std::string_view caption);

/// What each column means and where it comes from: one list, which the heads of all tables name.
void write_legend(Markup& out);

}  // namespace kerf::report
