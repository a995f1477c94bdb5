#include "kerf/study/study.h"

#include <algorithm>
#include <utility>

#include "kerf/base/error.h"
#include "kerf/scene/menu.h"
#include "kerf/scene/pipeline.h"
#include "kerf/study/end_point_overlap.h"

namespace kerf {
namespace {

constexpr double kSecondsOfBuilding = 10;  // quick builds are timed as often as rays, slow ones as often as fit in this

/// One row while it is measured.
struct Row : MeasuredRow {
  std::optional<double> overlap;

  bool is_finished() const { return scene != nullptr; }
};

bool has_option(const MenuEntry& entry, std::string_view name) {
  return std::any_of(entry.options.begin(), entry.options.end(), [&](const auto& spec) { return spec.name == name; });
}

class Study {
 public:
  Study(const StudyScene& scene, const StudyOptions& options)
      : input_(scene), options_(options), measure_(scene.description, options) {
    for (const std::string& row : options.rows) rows_.push_back({{parse_pipeline(row).text()}, {}});
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
      if (row.is_finished()) measure_.count(row, rays_);
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
    auto made = measure_.make_rays(input_.camera, options_.width, options_.height, options_.kinds);
    is_stopped_ = !made;
    if (made) made_ = std::move(*made);
    rays_ = made_;
  }

  /// False from the first time on that progress() wants no more.
  bool tell(const Row& row, const char* what, double share = 0) {
    if (options_.progress && !is_stopped_) {
      is_stopped_ = !options_.progress((done_ + share) / steps_, input_.name + ": " + what + " " + row.pipeline);
    }
    return !is_stopped_;
  }

  void build(Row& row) {
    measure_.build(row, [&](double share, std::string_view) { return tell(row, "build", share); });
    if (row.is_finished() && options_.with_overlap) measure_overlap(row);
  }

  void measure_overlap(Row& row) const {
    try {
      row.overlap = end_point_overlap(*row.scene, measure_.limit());
    } catch (const Error& error) {
      if (error.code() != ErrorCode::stopped) throw;
    }
  }

  void time(Row& row, int run) const {
    measure_.time(row, rays_);
    if (!row.is_finished()) return;
    const double first = row.builds.front().total;
    if (run > 0 && first * (run + 1) < kSecondsOfBuilding) measure_.time_build(row);
  }

  std::vector<StudyResult> results() const {
    std::vector<StudyResult> all;
    const size_t triangles = primitive_count(input_.description);
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
    const MeasuredRow::Traced& traced = row.traced[k];
    const double rays = std::max(1.0, static_cast<double>(rays_[k].rays.size()));
    result.references_per_triangle = row.report.references_per_primitive;
    result.sa_max = row.report.sa_max;
    std::vector<double> build_seconds;
    for (const BuildReport::Seconds& seconds : row.builds) build_seconds.push_back(seconds.total);
    result.build_seconds = spread_of(std::move(build_seconds));
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
    result.choice = row.report.choice;
    result.short_of_room = row.report.short_of_room;
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
  RowMeasure measure_;
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
