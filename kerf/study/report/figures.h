#pragma once

#include <span>
#include <string>

#include "kerf/study/report/markup.h"
#include "kerf/study/report/row_style.h"
#include "kerf/study/study.h"

namespace kerf::report {

using ResultSpan = std::span<const StudyResult* const>;

/// Charts of one table: bars of nodes, triangles and ray time for each row; ray time against references and bytes.
/// `id` begins the ids of all charts.
void write_scene_charts(Markup& out, ResultSpan results, const RowNumbers& numbers, const std::string& id);

/// Curves over R of one pipeline: ray time, nodes, triangles.
void write_sweep_charts(Markup& out, ResultSpan results, const std::string& id);

/// Curves over the number of triangles, a line for each row: build time, bytes, nodes and time of a ray.
void write_growth_charts(Markup& out, ResultSpan results, const RowNumbers& numbers, const std::string& id);

}  // namespace kerf::report
