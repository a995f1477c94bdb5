#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kerf/io/scene_description.h"
#include "kerf/references/split_result.h"
#include "kerf/study/row_measure.h"
#include "kerf/study/spread.h"
#include "kerf/study/study_rays.h"

namespace kerf {

/// What a paper printed for a row of its table.
struct PaperRow {
  double references_per_triangle, build_seconds, nodes_per_ray, triangles_per_ray, trace_seconds, speedup;
};

/// What one row of a study showed on one scene with one kind of rays: the columns of Table 1 of Ernst and Greiner 2007,
/// and more. Counts repeat exactly; times are of this machine.
struct StudyResult {
  std::string scene;
  size_t triangles = 0;  ///< primitives of the scene
  std::string row;       ///< the pipeline
  std::string rays;      ///< the kind, by name; "loaded" for rays from a file
  size_t ray_count = 0;

  bool finished = true;  ///< false: nothing but the fields above is known
  std::string why_not;   ///< a sentence: the limit that was reached, the option that was wrong

  double references_per_triangle = 0;  ///< R
  double sa_max = std::numeric_limits<double>::infinity();
  Spread build_seconds;  ///< references, splitting, building and layout
  double nodes_per_ray = 0, triangles_per_ray = 0, boxes_per_ray = 0;
  Spread trace_seconds;  ///< for all rays, one thread
  double speedup = 0;    ///< trace time of the first row that finished, over this one's: median of paired runs
  size_t bytes = 0;
  uint32_t depth = 0;
  double sah_cost = 0;
  std::optional<double> end_point_overlap;  ///< none: not asked for
  size_t hits = 0;
  uint64_t tree_hash = 0;
  std::optional<SplitChoice> choice;       ///< of automatic splitting: how far it went, and why
  std::vector<std::string> short_of_room;  ///< stages that the limit of bytes kept from cuts

  std::optional<PaperRow> paper;  ///< the row that this one stands beside
};

/// One scene of a study.
struct StudyScene {
  std::string name;
  SceneDescription description;
  Camera camera;
};

struct StudyOptions : MeasureOptions {
  std::vector<std::string> rows;  ///< pipelines; all are checked before any work is done
  uint32_t width = 1000, height = 1000;
  std::vector<RayKind> kinds{RayKind::primary};
  int repeat = 5;  ///< timed runs of each row, in turn with the others
  bool with_overlap = true;
  std::span<const StudyRays> loaded;  ///< traced instead of rays from the camera
  /// Called now and then with the share that is done and what is being done; returns false to stop.
  std::function<bool(double, std::string_view)> progress;
};

/// A row for everything in the menu that rays can be traced through, what splits at 1.5 references per triangle;
/// without brute force, which few scenes have time for.
std::vector<std::string> all_rows();

/// Builds every row over the scene, shoots the same rays through all of them and measures. In the order of the rows,
/// for each kind of rays in turn. A row that reaches a limit is there, not finished. Stopped by progress(), it returns
/// what is finished. Throws Error (invalid_option) for a row that is no pipeline, and what Scene::build() throws for
/// the scene itself.
std::vector<StudyResult> study(const StudyScene& scene, const StudyOptions& options);

}  // namespace kerf
