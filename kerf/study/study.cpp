#include "kerf/study/study.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <utility>

#include "kerf/base/error.h"
#include "kerf/render/render_scene.h"
#include "kerf/scene/menu.h"
#include "kerf/scene/pipeline.h"
#include "kerf/study/end_point_overlap.h"

namespace kerf {
namespace {

using Clock = std::chrono::steady_clock;

constexpr size_t kStretch = 4096;          // rays between two looks at the clock
constexpr double kSecondsOfBuilding = 10;  // quick builds are timed as often as rays, slow ones as often as fit in this

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

Spread spread_of(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const size_t n = values.size();
  return {(values[(n - 1) / 2] + values[n / 2]) / 2, values.front(), values.back(), static_cast<int>(n)};
}

/// One row while it is measured.
struct Row {
  std::string pipeline;
  std::unique_ptr<Scene> scene;  ///< none: not finished
  std::string why_not;
  BuildReport report;
  std::vector<double> build_seconds;
  std::optional<double> overlap;

  /// Of each kind of rays.
  struct Traced {
    TraceCounts counts;
    size_t hits = 0;
    std::vector<double> seconds;
  };
  std::vector<Traced> traced;

  bool is_finished() const { return scene != nullptr; }
  void give_up(const std::string& why) {
    scene.reset();
    why_not = why;
  }
};

bool has_option(const MenuEntry& entry, std::string_view name) {
  return std::any_of(entry.options.begin(), entry.options.end(), [&](const auto& spec) { return spec.name == name; });
}

class Study {
 public:
  Study(const StudyScene& scene, const StudyOptions& options) : input_(scene), options_(options) {
    for (const std::string& row : options.rows) rows_.push_back({parse_pipeline(row).text(), {}, {}, {}, {}, {}, {}});
  }

  std::vector<StudyResult> run() {
    make_rays();
    const size_t kinds = rays_.size();
    steps_ = static_cast<double>(rows_.size() * (1 + kinds * (1 + static_cast<size_t>(options_.repeat))));
    for (Row& row : rows_) {
      if (!tell(row, "build")) break;
      build(row);
      done_ += 1;
    }
    for (Row& row : rows_) {
      if (!tell(row, "count")) break;
      if (row.is_finished()) count(row);
      done_ += static_cast<double>(kinds);
    }
    for (int run = 0; run < options_.repeat && !is_stopped_; ++run) {
      for (Row& row : rows_) {
        if (!tell(row, "trace")) break;
        if (row.is_finished()) time(row, run);
        done_ += static_cast<double>(kinds);
      }
    }
    return results();
  }

 private:
  void make_rays() {
    if (!options_.loaded.empty()) {
      rays_ = options_.loaded;
      return;
    }
    made_ = make_study_rays(input_.description, input_.camera, options_.width, options_.height, options_.kinds,
                            options_.skip_invalid);
    rays_ = made_;
  }

  /// False from the first time on that progress() wants no more.
  bool tell(const Row& row, const char* what, double share = 0) {
    if (options_.progress && !is_stopped_) {
      is_stopped_ = !options_.progress((done_ + share) / steps_, input_.name + ": " + what + " " + row.pipeline);
    }
    return !is_stopped_;
  }

  WorkLimit limit() const {
    WorkLimit limit = WorkLimit::seconds(options_.limit_seconds);
    limit.bytes = options_.limit_bytes;
    limit.cancelled = options_.cancelled;
    return limit;
  }

  std::unique_ptr<Scene> built(const Row& row, WorkMeter::Progress progress = nullptr) const {
    return std::make_unique<Scene>(build_scene(input_.description, {.structure = row.pipeline,
                                                                    .threads = options_.threads,
                                                                    .skip_invalid = options_.skip_invalid,
                                                                    .limit = limit(),
                                                                    .progress = std::move(progress)}));
  }

  void build(Row& row) {
    try {
      row.scene = built(row, [&](double share, std::string_view) { return tell(row, "build", share); });
      row.report = row.scene->report();
      row.build_seconds.push_back(row.report.seconds.total);
      if (row.report.bytes > options_.limit_bytes) {
        row.give_up("it takes " + std::to_string(row.report.bytes) + " bytes");
      } else if (options_.with_overlap) {
        measure_overlap(row);
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

  void measure_overlap(Row& row) const {
    try {
      row.overlap = end_point_overlap(*row.scene, limit());
    } catch (const Error& error) {
      if (error.code() != ErrorCode::stopped) throw;
    }
  }

  /// Calls trace(begin, end) for stretches of the rays until all are done; false when the time is over.
  template <class F>
  bool in_time(size_t count, Clock::time_point start, F&& trace) const {
    for (size_t begin = 0; begin < count; begin += kStretch) {
      trace(begin, std::min(begin + kStretch, count));
      if (seconds_since(start) > options_.limit_seconds) return false;
      if (options_.cancelled != nullptr && *options_.cancelled) return false;
    }
    return true;
  }

  void count(Row& row) const {
    const Clock::time_point start = Clock::now();
    const Scene& scene = *row.scene;
    std::vector<Hit> hits(kStretch);
    for (const StudyRays& kind : rays_) {
      Row::Traced traced;
      const bool is_done = in_time(kind.rays.size(), start, [&](size_t begin, size_t end) {
        const std::span<const Ray> rays = std::span(kind.rays).subspan(begin, end - begin);
        if (kind.any_hit) {
          for (const Ray& ray : rays) traced.hits += scene.any_hit(ray, traced.counts) ? 1 : 0;
          return;
        }
        scene.closest_hit(rays, std::span(hits).first(rays.size()), traced.counts);
        for (size_t i = 0; i < rays.size(); ++i) traced.hits += hits[i] ? 1 : 0;
      });
      if (!is_done) return row.give_up("tracing its rays took more than the time allowed");
      row.traced.push_back(std::move(traced));
    }
  }

  void time(Row& row, int run) const {
    std::vector<Hit> hits(kStretch);
    std::vector<uint8_t> any(kStretch);
    const Clock::time_point all = Clock::now();
    for (size_t k = 0; k < rays_.size(); ++k) {
      const StudyRays& kind = rays_[k];
      const Clock::time_point start = Clock::now();
      const bool is_done = in_time(kind.rays.size(), all, [&](size_t begin, size_t end) {
        const std::span<const Ray> rays = std::span(kind.rays).subspan(begin, end - begin);
        if (kind.any_hit) {
          row.scene->any_hit(rays, std::span(any).first(rays.size()), 1);
        } else {
          row.scene->closest_hit(rays, std::span(hits).first(rays.size()), 1);
        }
      });
      if (!is_done) return row.give_up("tracing its rays took more than the time allowed");
      row.traced[k].seconds.push_back(seconds_since(start));
    }
    const double first = row.build_seconds.front();
    if (run > 0 && first * (run + 1) < kSecondsOfBuilding) time_build(row);
  }

  std::vector<StudyResult> results() const {
    std::vector<StudyResult> all;
    size_t triangles = 0;
    for (const SceneObject& object : input_.description.objects) {
      const auto* mesh = std::get_if<Mesh>(&object.shape);
      triangles += mesh != nullptr ? mesh->triangles.size() : 1;
    }
    for (size_t k = 0; k < rays_.size(); ++k) {
      for (const Row& row : rows_) {
        StudyResult result;
        result.scene = input_.name;
        result.triangles = triangles;
        result.row = row.pipeline;
        result.rays = rays_[k].kind;
        result.ray_count = rays_[k].rays.size();
        result.finished = row.is_finished() && k < row.traced.size() && !row.traced[k].seconds.empty();
        if (result.finished) {
          fill(result, row, k);
        } else {
          result.why_not = row.why_not.empty() ? "it was interrupted" : row.why_not;
        }
        all.push_back(std::move(result));
      }
    }
    return all;
  }

  void fill(StudyResult& result, const Row& row, size_t k) const {
    const Row::Traced& traced = row.traced[k];
    const double rays = std::max(1.0, static_cast<double>(rays_[k].rays.size()));
    result.references_per_triangle = row.report.references_per_primitive;
    result.sa_max = row.report.sa_max;
    result.build_seconds = spread_of(row.build_seconds);
    result.nodes_per_ray = static_cast<double>(traced.counts.nodes) / rays;
    result.triangles_per_ray = static_cast<double>(traced.counts.primitives) / rays;
    result.boxes_per_ray = static_cast<double>(traced.counts.boxes) / rays;
    result.trace_seconds = spread_of(traced.seconds);
    result.speedup = speedup(traced.seconds, k);
    result.bytes = row.report.bytes;
    result.depth = row.report.depth;
    result.sah_cost = row.report.sah_cost;
    result.end_point_overlap = row.overlap;
    result.hits = traced.hits;
    result.tree_hash = row.report.tree_hash;
  }

  /// Another sample of the build's time, if it is to be had.
  void time_build(Row& row) const {
    try {
      row.build_seconds.push_back(built(row)->report().seconds.total);
    } catch (const Error& error) {
      if (error.code() != ErrorCode::stopped) throw;
    } catch (const std::bad_alloc&) {  // what is there is kept
    }
  }

  double speedup(const std::vector<double>& seconds, size_t k) const {
    const auto first = std::find_if(rows_.begin(), rows_.end(), [](const Row& row) { return row.is_finished(); });
    const std::vector<double>& base = first->traced[k].seconds;
    std::vector<double> ratios;
    for (size_t i = 0; i < std::min(base.size(), seconds.size()); ++i) ratios.push_back(base[i] / seconds[i]);
    return spread_of(std::move(ratios)).median;
  }

  const StudyScene& input_;
  const StudyOptions& options_;
  std::vector<Row> rows_;
  std::vector<StudyRays> made_;
  std::span<const StudyRays> rays_;
  double done_ = 0, steps_ = 1;
  bool is_stopped_ = false;
};

}  // namespace

std::vector<std::string> all_rows() {
  std::vector<std::string> rows;
  for (const MenuEntry& entry : menu()) {
    const std::string name(entry.name);
    if (name == "brute_force" || name == "bvh2") continue;  // bvh2 is what a builder alone means
    const bool is_splitting = name != "embree_high" && has_option(entry, "budget");
    const std::string stage = is_splitting ? name + "(budget=1.5)" : name;
    rows.push_back(entry.kind == "splitter" ? stage + "+binned_sah"
                   : entry.takes_tree()     ? "binned_sah+" + stage
                                            : stage);
  }
  return rows;
}

std::vector<StudyResult> study(const StudyScene& scene, const StudyOptions& options) {
  return Study(scene, options).run();
}

}  // namespace kerf
