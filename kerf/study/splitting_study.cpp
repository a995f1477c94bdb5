#include "kerf/study/splitting_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "kerf/base/error.h"
#include "kerf/render/render_scene.h"
#include "kerf/scene/pipeline.h"
#include "kerf/study/turn.h"

namespace kerf {
namespace {

constexpr double kSecondsOfBuilding = 60;  // for repeated builds of all timed rows together
constexpr int kLeastBuilds = 3;
constexpr int kThreads[] = {1, 2, 7};

struct Variant {
  const char* what;
  double factor;
  bool is_exchanged;
};
constexpr Variant kVariants[] = {
    {"1e-3 times the size", 1e-3, false}, {"1e6 times the size", 1e6, false}, {"axes exchanged", 1, true}};

bool is_in_menu(const std::string& pipeline) {
  try {
    parse_pipeline(pipeline);
    return true;
  } catch (const Error&) {
    return false;
  }
}

class SplittingStudy {
 public:
  SplittingStudy(const StudyScene& scene, const std::string& turn, const SplittingOptions& options)
      : input_(scene), options_(options), measure_(scene.description, options) {
    result_.name = scene.name;
    result_.turn = turn;
    result_.triangles = primitive_count(scene.description);
    for (const SplittingRowEntry& entry : splitting_study_rows()) add_row(entry.role, std::string(entry.pipeline), 0);
    for (const double budget : splitting_budgets()) add_row(SplittingRole::budget, budget_pipeline(budget), budget);
    steps_ = static_cast<double>(2 * measured_.size() + static_cast<size_t>(options.repeat) * timed().size() +
                                 std::size(kVariants) + 2 + (options.with_threads ? 3 * std::size(kThreads) : 0));
  }

  SplittingScene run() {
    make_rays();
    count_rows();
    time_rows();
    for (size_t i = 0; i < measured_.size(); ++i) keep_times(i);
    measured_.clear();
    check_variants();
    check_cap();
    check_refusal();
    check_threads();
    return std::move(result_);
  }

 private:
  void add_row(SplittingRole role, const std::string& pipeline, double budget) {
    SplittingRow row;
    row.role = role;
    row.pipeline = pipeline;
    row.budget = budget;
    result_.rows.push_back(std::move(row));
    measured_.push_back({pipeline});
  }

  /// Numbers of the timed rows.
  std::vector<size_t> timed() const {
    std::vector<size_t> numbers;
    for (size_t i = 0; i < splitting_study_rows().size(); ++i) {
      if (splitting_study_rows()[i].is_timed) numbers.push_back(i);
    }
    return numbers;
  }

  void make_rays() {
    auto made = measure_.make_rays(input_.camera, options_.width, options_.height, options_.kinds);
    is_stopped_ = !made;
    if (made) rays_ = std::move(*made);
    for (const StudyRays& rays : rays_) {
      result_.kinds.push_back(rays.kind);
      result_.ray_counts.push_back(rays.rays.size());
    }
  }

  /// False from the first time on that progress() wants no more.
  bool tell(std::string_view what) {
    if (options_.progress && !is_stopped_) {
      is_stopped_ = !options_.progress(std::min(1.0, done_ / steps_), fmt::format("{}: {}", result_.title(), what));
    }
    return !is_stopped_;
  }

  /// Builds each row and counts; what is not timed is let go at once.
  void count_rows() {
    for (size_t i = 0; i < measured_.size(); ++i) {
      MeasuredRow& row = measured_[i];
      if (!tell("build " + row.pipeline)) return;
      if (is_in_menu(row.pipeline)) {
        measure_.build(row);
      } else {
        row.give_up("it is not in the menu of this build");
      }
      done_ += 1;
      if (!tell("count " + row.pipeline)) return;
      if (row.scene) measure_.count(row, rays_);
      done_ += 1;
      if (is_interrupted()) return;
      keep_counts(row, result_.rows[i]);
      const bool is_timed = i < splitting_study_rows().size() && splitting_study_rows()[i].is_timed;
      if (!is_timed) row.scene.reset();
    }
  }

  /// What was stopped half way is not kept.
  bool is_interrupted() const { return options_.cancelled != nullptr && *options_.cancelled; }

  void keep_counts(const MeasuredRow& from, SplittingRow& to) const {
    to.finished = from.scene != nullptr;
    to.why_not = from.why_not;
    if (!to.finished) return;
    const BuildReport& report = from.report;
    to.pipeline = report.structure;
    to.references_per_primitive = report.references_per_primitive;
    to.sah_cost = report.sah_cost;
    to.bytes = report.bytes;
    to.peak_bytes = report.peak_bytes;
    to.tree_hash = report.tree_hash;
    to.builds = from.builds;
    to.choice = report.choice;
    to.short_of_room = report.short_of_room;
    for (size_t k = 0; k < rays_.size(); ++k) {
      const MeasuredRow::Traced& traced = from.traced[k];
      const double count = std::max(1.0, static_cast<double>(rays_[k].rays.size()));
      to.rays.push_back({static_cast<double>(traced.counts.nodes) / count,
                         static_cast<double>(traced.counts.primitives) / count,
                         traced.hits,
                         {}});
    }
  }

  /// The timed rows take turns with each kind of rays, every other run backwards, so that none always comes after the
  /// same one; then in building, as long as there is time for it.
  void time_rows() {
    std::vector<size_t> turns = timed();
    double seconds = 0;
    for (const size_t i : turns) seconds += measured_[i].scene ? measured_[i].builds.front().total : 0;
    for (int run = 0; run < options_.repeat; ++run) {
      if (!tell(fmt::format("run {} of {}", run + 1, options_.repeat))) return;
      for (size_t k = 0; k < rays_.size(); ++k) {
        for (const size_t i : turns) {
          if (measured_[i].scene) measure_.time(measured_[i], rays_, k);
        }
      }
      const bool has_time = run < kLeastBuilds || seconds * (run + 1) < kSecondsOfBuilding;
      for (const size_t i : turns) {
        if (run > 0 && has_time && measured_[i].scene && tell("build again")) measure_.time_build(measured_[i]);
      }
      std::reverse(turns.begin(), turns.end());
      done_ += static_cast<double>(turns.size());
    }
  }

  void keep_times(size_t i) {
    const MeasuredRow& from = measured_[i];
    SplittingRow& to = result_.rows[i];
    if (!to.finished) return;
    to.builds = from.builds;
    for (size_t k = 0; k < to.rays.size(); ++k) to.rays[k].seconds = from.traced[k].seconds;
    if (!from.why_not.empty() && !is_interrupted()) {
      result_.skipped.push_back(fmt::format("ray times of {}: {}", from.pipeline, from.why_not));
    }
  }

  /// Runs one check; what it says when it is not possible stands in the result.
  template <class F>
  void check(const std::string& what, F&& f) {
    if (!tell(what)) return;
    try {
      f();
    } catch (const Error& error) {
      if (error.code() != ErrorCode::stopped && error.code() != ErrorCode::invalid_option &&
          error.code() != ErrorCode::too_large) {
        throw;
      }
      result_.skipped.push_back(what + ": " + error.what());
    } catch (const std::bad_alloc&) {
      result_.skipped.push_back(what + ": there is not enough memory");
    }
    done_ += 1;
  }

  BuildReport report_of(const SceneDescription& scene, std::string_view pipeline, int threads, WorkLimit limit) const {
    return build_scene(scene, {.structure = std::string(pipeline),
                               .threads = threads,
                               .skip_invalid = options_.skip_invalid,
                               .limit = limit})
        .report();
  }

  void check_variants() {
    const std::string_view pipeline = splitting_row(SplittingRole::automatic).pipeline;
    for (const Variant& variant : kVariants) {
      check(fmt::format("auto, {}", variant.what), [&] {
        const SceneDescription other = variant.is_exchanged ? turned(input_.description, axes_exchanged())
                                                            : scaled(input_.description, variant.factor);
        const BuildReport report = report_of(other, pipeline, options_.threads, measure_.limit());
        result_.variants.push_back({variant.what, report.references_per_primitive});
      });
    }
  }

  void check_cap() {
    check(fmt::format("auto, cap {}", kSplittingCap), [&] {
      const std::string pipeline = fmt::format("early_split(auto,cap={})+binned_sah", kSplittingCap);
      result_.capped_references =
          report_of(input_.description, pipeline, options_.threads, measure_.limit()).references_per_primitive;
    });
  }

  /// A byte for each primitive is less than any structure takes.
  void check_refusal() {
    if (result_.triangles == 0) return;
    check("a byte limit that cannot be kept", [&] {
      SplittingRefusal refusal;
      refusal.allowed = result_.triangles;
      WorkLimit limit = measure_.limit();
      limit.bytes = refusal.allowed;
      const auto start = std::chrono::steady_clock::now();
      try {
        report_of(input_.description, limited_pipeline(), options_.threads, limit);
      } catch (const Error& error) {
        refusal.is_refused = error.code() == ErrorCode::stopped && !is_interrupted();
        refusal.sentence = error.what();
      }
      refusal.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      if (!is_interrupted()) result_.refusal = refusal;
    });
  }

  /// `balanced`, or what stands for it where there are no presets.
  std::string limited_pipeline() const {
    const SplittingRole role =
        result_.row(SplittingRole::balanced) != nullptr ? SplittingRole::balanced : SplittingRole::automatic;
    return std::string(splitting_row(role).pipeline);
  }

  void check_threads() {
    if (!options_.with_threads) {
      result_.skipped.emplace_back("trees for 1, 2 and 7 threads: left out as asked");
      return;
    }
    for (const SplittingRowEntry& entry : splitting_study_rows()) {
      if (!entry.is_repeatable || result_.row(entry.role) == nullptr) continue;
      SplittingTrees trees{entry.role, {}, {}};
      for (const int threads : kThreads) {
        check(fmt::format("{} with {} threads", entry.name, threads), [&] {
          trees.hashes.push_back(report_of(input_.description, entry.pipeline, threads, measure_.limit()).tree_hash);
          trees.threads.push_back(threads);
        });
      }
      if (!trees.threads.empty()) result_.trees.push_back(std::move(trees));
    }
  }

  const StudyScene& input_;
  const SplittingOptions& options_;
  RowMeasure measure_;
  SplittingScene result_;
  std::vector<MeasuredRow> measured_;  // as result_.rows
  std::vector<StudyRays> rays_;
  double done_ = 0, steps_ = 1;
  bool is_stopped_ = false;
};

}  // namespace

SplittingScene study_splitting(const StudyScene& scene, const std::string& turn, const SplittingOptions& options) {
  return SplittingStudy(scene, turn, options).run();
}

}  // namespace kerf
