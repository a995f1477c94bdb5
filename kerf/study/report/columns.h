#pragma once

#include <span>
#include <string>
#include <string_view>

#include "kerf/study/report/number_text.h"
#include "kerf/study/study.h"

namespace kerf::report {

enum class Quantity { number, ratio, count, seconds, bytes };
enum class Best { none, least, most };

/// A column of a report's tables: what it is called, what it means, where its numbers are.
struct Column {
  std::string_view id;      ///< in anchors
  std::string_view symbol;  ///< of Table 1, with what stands lowered behind it
  std::string_view lowered;
  std::string_view words;     ///< a few
  std::string_view sentence;  ///< in plain words, for the legend
  Quantity quantity = Quantity::number;
  Best best = Best::none;
  double (*value)(const StudyResult&) = nullptr;  ///< NaN: not known
  const Spread* (*spread)(const StudyResult&) = nullptr;
  double (*paper)(const PaperRow&) = nullptr;
};

/// All columns, from left to right; the first are those of Table 1.
std::span<const Column> columns();

/// The column of that id.
const Column& column(std::string_view id);

/// The unit that suits most rows of a column; of size 1 and without a name where its numbers have none.
Unit column_unit(const Column& column, std::span<const StudyResult* const> results);

/// A value of the column in that unit, without the unit's name.
std::string value_text(const Column& column, double value, const Unit& unit);

}  // namespace kerf::report
