#include "kerf/study/row_measure.h"

#include <algorithm>
#include <chrono>
#include <new>

#include "kerf/base/error.h"
#include "kerf/render/render_scene.h"

namespace kerf {
namespace {

using Clock = std::chrono::steady_clock;

constexpr size_t kStretch = 4096;  // rays between two looks at the clock
constexpr const char* kTooLong = "tracing its rays took more than the time allowed";

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Calls trace(begin, end) for stretches of the rays until all are done; false when the time is over.
template <class F>
bool in_time(const MeasureOptions& options, size_t count, Clock::time_point start, F&& trace) {
  for (size_t begin = 0; begin < count; begin += kStretch) {
    trace(begin, std::min(begin + kStretch, count));
    if (seconds_since(start) > options.limit_seconds) return false;
    if (options.cancelled != nullptr && *options.cancelled) return false;
  }
  return true;
}

}  // namespace

WorkLimit RowMeasure::limit() const {
  WorkLimit limit = WorkLimit::seconds(options_.limit_seconds);
  limit.bytes = options_.limit_bytes;
  limit.cancelled = options_.cancelled;
  return limit;
}

std::optional<std::vector<StudyRays>> RowMeasure::make_rays(const Camera& camera, uint32_t width, uint32_t height,
                                                            std::span<const RayKind> kinds) const {
  WorkLimit limit;
  limit.cancelled = options_.cancelled;
  try {
    return make_study_rays(scene_, camera, width, height, kinds, options_.skip_invalid, limit);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::stopped) throw;
    return std::nullopt;
  }
}

std::unique_ptr<Scene> RowMeasure::built(const MeasuredRow& row, WorkMeter::Progress progress) const {
  return std::make_unique<Scene>(build_scene(scene_, {.structure = row.pipeline,
                                                      .threads = options_.threads,
                                                      .skip_invalid = options_.skip_invalid,
                                                      .limit = limit(),
                                                      .progress = std::move(progress)}));
}

void RowMeasure::build(MeasuredRow& row, WorkMeter::Progress progress) const {
  try {
    row.scene = built(row, std::move(progress));
    row.report = row.scene->report();
    row.builds.push_back(row.report.seconds);
    if (row.report.bytes > options_.limit_bytes) {
      row.give_up("it takes " + std::to_string(row.report.bytes) + " bytes");
    }
  } catch (const Error& error) {
    // What is wrong with the scene is wrong for all rows.
    if (error.code() != ErrorCode::stopped && error.code() != ErrorCode::too_large &&
        error.code() != ErrorCode::invalid_option) {
      throw;
    }
    row.give_up(error.what());
  } catch (const std::bad_alloc&) {
    row.give_up("there is not enough memory");
  }
}

void RowMeasure::count(MeasuredRow& row, std::span<const StudyRays> rays) const {
  const Clock::time_point start = Clock::now();
  const Scene& scene = *row.scene;
  std::vector<Hit> hits(kStretch);
  for (const StudyRays& kind : rays) {
    MeasuredRow::Traced traced;
    const bool is_done = in_time(options_, kind.rays.size(), start, [&](size_t begin, size_t end) {
      const std::span<const Ray> some = std::span(kind.rays).subspan(begin, end - begin);
      if (kind.any_hit) {
        for (const Ray& ray : some) traced.hits += scene.any_hit(ray, traced.counts) ? 1 : 0;
        return;
      }
      scene.closest_hit(some, std::span(hits).first(some.size()), traced.counts);
      for (size_t i = 0; i < some.size(); ++i) traced.hits += hits[i] ? 1 : 0;
    });
    if (!is_done) return row.give_up(kTooLong);
    row.traced.push_back(std::move(traced));
  }
}

void RowMeasure::time(MeasuredRow& row, std::span<const StudyRays> rays) const {
  const Clock::time_point start = Clock::now();
  for (size_t k = 0; k < rays.size() && row.scene != nullptr; ++k) time_since(start, row, rays, k);
}

void RowMeasure::time(MeasuredRow& row, std::span<const StudyRays> rays, size_t kind) const {
  time_since(Clock::now(), row, rays, kind);
}

/// `start`: when the time allowed began to pass.
void RowMeasure::time_since(Clock::time_point start, MeasuredRow& row, std::span<const StudyRays> rays,
                            size_t kind) const {
  std::vector<Hit> hits(kStretch);
  std::vector<uint8_t> any(kStretch);
  const StudyRays& all = rays[kind];
  const Clock::time_point begun = Clock::now();
  const bool is_done = in_time(options_, all.rays.size(), start, [&](size_t begin, size_t end) {
    const std::span<const Ray> some = std::span(all.rays).subspan(begin, end - begin);
    if (all.any_hit) {
      row.scene->any_hit(some, std::span(any).first(some.size()), 1);
    } else {
      row.scene->closest_hit(some, std::span(hits).first(some.size()), 1);
    }
  });
  if (!is_done) return row.give_up(kTooLong);
  row.traced[kind].seconds.push_back(seconds_since(begun));
}

void RowMeasure::time_build(MeasuredRow& row) const {
  try {
    row.builds.push_back(built(row, nullptr)->report().seconds);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::stopped) throw;
  } catch (const std::bad_alloc&) {  // what is there is kept
  }
}

size_t primitive_count(const SceneDescription& scene) {
  size_t count = 0;
  for (const SceneObject& object : scene.objects) {
    const auto* mesh = std::get_if<Mesh>(&object.shape);
    count += mesh != nullptr ? mesh->triangles.size() : 1;
  }
  return count;
}

}  // namespace kerf
