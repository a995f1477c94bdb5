#pragma once

#include <span>
#include <string>
#include <vector>

#include "kerf/references/split_result.h"
#include "kerf/study/report/markup.h"
#include "kerf/study/splitting_result.h"

namespace kerf::report {

/// The curve from which automatic splitting chose: predicted cost over references, with its reason. `id` is of this
/// chart alone.
void write_choice_chart(Markup& out, const SplitChoice& choice, const std::string& id);

/// Visits over references of a scene's rows: the sweep as a line, the others as marks; the curve of the automatic
/// choice beside it, and each kind of rays by itself below. `id` begins the ids of all charts.
void write_splitting_charts(Markup& out, const SplittingScene& scene, const std::string& id);

/// All scenes on one scale: what automatic splitting, the best of the sweep, SBVH and presets leave of the visits.
void write_splitting_overview(Markup& out, std::span<const SplittingScene> scenes, const std::string& id);

}  // namespace kerf::report
