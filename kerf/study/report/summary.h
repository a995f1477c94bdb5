#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kerf/study/report/markup.h"
#include "kerf/study/report/row_style.h"
#include "kerf/study/study.h"

namespace kerf::report {

/// Results that belong together, in the order in which they came.
struct ResultGroup {
  std::string scene, rays;
  std::vector<const StudyResult*> results;
};

/// One group for each scene and kind of rays, scenes and kinds in the order in which they first came.
std::vector<ResultGroup> grouped_results(std::span<const StudyResult> results);

/// What a table shows, in sentences: the fastest row, how sure that is, rows that did not finish, whether all rows
/// found the same hits.
void write_findings(Markup& out, const ResultGroup& group, const RowNumbers& numbers);

/// The speed-up of each row in each group, with their geometric mean for rows that finished everywhere. Nothing where
/// there is only one group.
void write_overview(Markup& out, std::span<const ResultGroup> groups, const RowNumbers& numbers);

}  // namespace kerf::report
