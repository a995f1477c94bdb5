#pragma once

#include <string_view>

namespace kerf::report {

/// How a report looks: light and dark, on paper, on a telephone. Holds neither "<" nor "&", so that it is XML too.
std::string_view page_style();

/// What a report does when asked: tables are sorted by the column whose head is clicked, a row that is pointed at
/// lights up in all charts, and everything is unfolded for print. Nothing is missing without it.
std::string_view page_script();

}  // namespace kerf::report
