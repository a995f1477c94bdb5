#pragma once

#include <atomic>
#include <chrono>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kerf/io/scene_description.h"
#include "kerf/scene/scene.h"
#include "kerf/study/study_rays.h"

namespace kerf {

/// One row of a study while it is measured.
struct MeasuredRow {
  std::string pipeline;
  std::unique_ptr<Scene> scene = nullptr;  ///< none: not built yet, or given up
  std::string why_not = {};                ///< a sentence, where it was given up
  BuildReport report = {};                 ///< of the first build
  std::vector<BuildReport::Seconds> builds = {};

  /// Of each kind of rays.
  struct Traced {
    TraceCounts counts;
    size_t hits = 0;
    std::vector<double> seconds;  ///< of each run over all rays, on one thread
  };
  std::vector<Traced> traced = {};

  void give_up(const std::string& why) {
    scene.reset();
    why_not = why;
  }
};

struct MeasureOptions {
  int threads = 0;  ///< of builds
  double limit_seconds =
      std::numeric_limits<double>::infinity();   ///< of one build, and of what is done with rays at once
  size_t limit_bytes = static_cast<size_t>(-1);  ///< of one build
  bool skip_invalid = false;
  const std::atomic<bool>* cancelled = nullptr;
};

/// Builds rows over one scene, counts their work and times them. A row that reaches a limit or that cannot be built is
/// given up, with a sentence; what is wrong with the scene itself is thrown, as build_scene() does.
class RowMeasure {
 public:
  /// Both must outlive it.
  RowMeasure(const SceneDescription& scene, const MeasureOptions& options) : scene_(scene), options_(options) {}

  /// From now on.
  WorkLimit limit() const;
  /// make_study_rays(); nothing where it was cancelled.
  std::optional<std::vector<StudyRays>> make_rays(const Camera& camera, uint32_t width, uint32_t height,
                                                  std::span<const RayKind> kinds) const;

  /// `progress` as that of BuildOptions.
  void build(MeasuredRow& row, WorkMeter::Progress progress = nullptr) const;
  /// The work of all rays, kind by kind.
  void count(MeasuredRow& row, std::span<const StudyRays> rays) const;
  /// One more run over all rays, which were counted before, or over those of one kind, by number.
  void time(MeasuredRow& row, std::span<const StudyRays> rays) const;
  void time(MeasuredRow& row, std::span<const StudyRays> rays, size_t kind) const;
  /// One more sample of the build's time, if it is to be had.
  void time_build(MeasuredRow& row) const;

 private:
  using Clock = std::chrono::steady_clock;

  std::unique_ptr<Scene> built(const MeasuredRow& row, WorkMeter::Progress progress) const;
  void time_since(Clock::time_point start, MeasuredRow& row, std::span<const StudyRays> rays, size_t kind) const;

  const SceneDescription& scene_;
  const MeasureOptions& options_;
};

/// Meshes' triangles; a sphere and a parallelogram count as one.
size_t primitive_count(const SceneDescription& scene);

}  // namespace kerf
