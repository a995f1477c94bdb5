#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "kerf/study/bench_result.h"
#include "kerf/study/row_measure.h"
#include "kerf/study/study.h"

namespace kerf {

/// `threads` build and trace; not more than the machine has, for Embree takes no more.
struct BenchOptions : MeasureOptions {
  std::vector<std::string> rows;  ///< pipelines; all are checked before any work is done
  bool with_embree = true;        ///< where this build knows it
  uint32_t width = 480, height = 320;
  std::vector<RayKind> kinds{RayKind::primary, RayKind::diffuse, RayKind::shadow};
  int repeat = 7;  ///< timed runs of each row, in turn with the others
  /// Called now and then with the share that is done and what is being done; returns false to stop.
  std::function<bool(double, std::string_view)> progress;
};

/// The presets, each as it is and with the wide layouts that the menu has.
std::vector<std::string> bench_rows();

/// Builds every row and Embree's qualities over the scene, traces the same rays through all of them, fed in every way
/// that a row knows, in turn, and times that. `turn` is how the scene was turned before.
///
/// Before anything is timed each row's answers are compared: with those of Embree's robust scene (another answer: one
/// hits and the other does not, or their distances differ by more than a thousandth), and Kerf's rows with the first of
/// them. A row that reaches a limit or cannot be built is there, not finished, and says why. Stopped by progress(), it
/// returns what is measured. Throws Error (invalid_option) for a row that is no pipeline, and what build_scene() throws
/// for the scene itself.
BenchScene bench(const StudyScene& scene, const std::string& turn, const BenchOptions& options);

}  // namespace kerf
