#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "kerf/study/row_measure.h"
#include "kerf/study/splitting_result.h"
#include "kerf/study/study.h"

namespace kerf {

struct SplittingOptions : MeasureOptions {
  uint32_t width = 150, height = 100;
  std::vector<RayKind> kinds{RayKind::primary, RayKind::shadow, RayKind::diffuse};
  int repeat = 15;  ///< runs of the timed rows, in turn; their builds are repeated as often as fits in some seconds
  bool with_threads = true;  ///< compare trees built with 1, 2 and 7 threads
  /// Called now and then with the share that is done and what is being done; returns false to stop.
  std::function<bool(double, std::string_view)> progress;
};

/// Measures what splitting does to a scene, as it stands here, with everything that splitting_goals.h judges. `turn` is
/// how the scene was turned before. A row that reaches a limit or that this build does not have is there, not finished,
/// and says why. Stopped by progress(), it returns what is finished. Throws as build_scene() does for the scene itself.
SplittingScene study_splitting(const StudyScene& scene, const std::string& turn, const SplittingOptions& options);

}  // namespace kerf
