#include "kerf/study/bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <new>
#include <optional>
#include <utility>

#include "kerf/base/error.h"
#include "kerf/base/parallel.h"
#include "kerf/scene/menu.h"
#include "kerf/study/bench_kerf.h"
#include "kerf/study/embree_rival.h"
#include "kerf/study/ray_order.h"

namespace kerf {
namespace {

constexpr std::string_view kWideLayouts[] = {"bvh8", "bvh4", "quantised_bvh8"};
constexpr int kLeastBuilds = 3;
constexpr double kSecondsOfBuilding = 30;  // for more builds than that, of all rows together
constexpr const char* kTooLong = "tracing its rays took more than the time allowed";
constexpr float kSameDistance = 1e-3F;  // Embree's is not exact

bool is_same_answer(const Hit& a, const Hit& b) {
  if (!a || !b) return !a && !b;
  return std::abs(a.t - b.t) <= kSameDistance * std::max(std::abs(a.t), std::abs(b.t));
}

template <class F>
size_t count_unlike(const std::vector<Hit>& a, const std::vector<Hit>& b, F&& is_like) {
  size_t count = 0;
  for (size_t i = 0; i < a.size(); ++i) count += is_like(a[i], b[i]) ? 0 : 1;
  return count;
}

class Bench {
 public:
  Bench(const StudyScene& scene, const std::string& turn, const BenchOptions& options)
      : input_(scene), options_(options), measure_(scene.description, options_) {
    if (options_.threads <= 0) options_.threads = thread_count();
    result_.name = scene.name;
    result_.turn = turn;
    result_.threads = options_.threads;
    result_.triangles = primitive_count(scene.description);
    for (const std::string& row : options.rows) {
      subjects_.push_back(kerf_subject(scene.description, row, options_));
    }
  }

  BenchScene run() {
    make_rays();
    add_embree();
    for (const auto& subject : subjects_) result_.rows.push_back(subject->describe());
    steps_ = static_cast<double>(subjects_.size() * (2 + static_cast<size_t>(options_.repeat)));
    build_rows();
    compare_rows();
    time_rows();
    for (BenchRow& row : result_.rows) keep_timed(row);
    return std::move(result_);
  }

 private:
  void make_rays() {
    auto made = measure_.make_rays(input_.camera, options_.width, options_.height, options_.kinds);
    is_stopped_ = !made;
    if (made) rays_ = std::move(*made);
    for (const StudyRays& rays : rays_) {
      result_.kinds.push_back(rays.kind);
      result_.ray_counts.push_back(rays.rays.size());
      orders_.push_back(ray_order(rays.rays));
    }
  }

  void add_embree() {
#ifdef KERF_HAVE_EMBREE
    if (!options_.with_embree || is_stopped_) return;
    EmbreeRival rival = embree_rival(input_.description, options_.threads);
    result_.rival = std::move(rival.settings);
    for (auto& subject : rival.subjects) subjects_.push_back(std::move(subject));
#endif
  }

  /// False from the first time on that progress() wants no more.
  bool tell(const char* what, const BenchRow& row) {
    if (options_.progress && !is_stopped_) {
      is_stopped_ = !options_.progress(std::min(1.0, done_ / steps_),
                                       fmt::format("{}: {} {}", result_.title(), what, row.name()));
    }
    return !is_stopped_;
  }

  /// Calls f(); gives the row up where it reaches a limit, with that sentence or the error's own.
  template <class F>
  void within_limits(size_t i, const char* sentence, F&& f) {
    try {
      f();
    } catch (const Error& error) {
      if (error.code() != ErrorCode::stopped && error.code() != ErrorCode::too_large &&
          error.code() != ErrorCode::invalid_option) {
        throw;
      }
      give_up(i, error.code() == ErrorCode::stopped && sentence != nullptr ? sentence : error.what());
    } catch (const std::bad_alloc&) {
      give_up(i, "there is not enough memory");
    }
  }

  bool is_interrupted() const { return options_.cancelled != nullptr && *options_.cancelled; }

  void give_up(size_t i, const std::string& why) {
    subjects_[i].reset();
    if (is_interrupted() && result_.rows[i].finished) return;  // what was measured stays
    result_.rows[i].runs.clear();
    result_.rows[i].finished = false;
    result_.rows[i].why_not = is_interrupted() ? "it was interrupted" : why;
  }

  bool is_there(size_t i) const { return subjects_[i] != nullptr && result_.rows[i].finished; }

  void build_rows() {
    for (size_t i = 0; i < subjects_.size() && tell("build", result_.rows[i]); ++i) {
      within_limits(i, nullptr, [&] { result_.rows[i] = subjects_[i]->build(measure_.limit()); });
      done_ += 1;
    }
  }

  RaysToTrace rays_of(size_t kind) const { return {rays_[kind], orders_[kind], options_.threads, measure_.limit()}; }

  std::vector<Hit> answers(size_t i, const RaysToTrace& rays, Feed feed) const {
    const std::unique_ptr<BenchPass> pass = subjects_[i]->prepare(rays, feed);
    pass->trace();
    return pass->hits();
  }

  /// The first finished row that `is_it`, by number.
  template <class F>
  std::optional<size_t> find(F&& is_it) const {
    for (size_t i = 0; i < result_.rows.size(); ++i) {
      if (is_there(i) && is_it(result_.rows[i])) return i;
    }
    return std::nullopt;
  }

  BenchVerdicts judge_kind(size_t kerf, size_t robust, size_t kind) const {
    StudyRays rays = rays_[kind];
    rays.any_hit = false;
    const RaysToTrace all{rays, orders_[kind], options_.threads, measure_.limit()};
    const std::vector<Hit> ours = answers(kerf, all, Feed::loop), theirs = answers(robust, all, Feed::loop);
    BenchVerdicts verdicts;
    for (size_t i = 0; i < ours.size(); ++i) {
      const auto verdict = judge(input_.description.objects, rays.rays[i], ours[i], theirs[i]);
      ++(verdict ? verdicts.counts[static_cast<size_t>(*verdict)] : verdicts.not_judged);
    }
    return verdicts;
  }

  /// The answers of a row that others are compared with; none of a kind on which it was given up.
  std::vector<std::vector<Hit>> all_answers(std::optional<size_t> i) {
    std::vector<std::vector<Hit>> all;
    for (size_t kind = 0; kind < rays_.size() && i && is_there(*i); ++kind) {
      within_limits(*i, kTooLong, [&] { all.push_back(answers(*i, rays_of(kind), Feed::loop)); });
    }
    return all;
  }

  /// One run of everything that is to be timed, for its hits; it warms up what is warmed up by tracing.
  void compare_rows() {
    if (is_stopped_) return;
    const auto robust =
        find([](const BenchRow& row) { return row.engine == BenchEngine::embree && row.quality == "robust"; });
    const auto of_robust = all_answers(robust);
    std::vector<std::vector<Hit>> of_first;
    while (of_first.size() < rays_.size()) {  // a row that is given up makes room for the next one
      const auto first = find([](const BenchRow& row) { return row.engine == BenchEngine::kerf; });
      if (!first || is_interrupted()) break;
      of_first = all_answers(first);
      for (size_t kind = 0; kind < rays_.size() && is_there(*first) && robust && is_there(*robust); ++kind) {
        within_limits(*robust, kTooLong, [&] { result_.verdicts.push_back(judge_kind(*first, *robust, kind)); });
      }
    }
    for (size_t i = 0; i < subjects_.size() && tell("compare", result_.rows[i]); ++i) {
      if (is_there(i)) within_limits(i, kTooLong, [&] { compare(i, of_robust, of_first); });
      done_ += 1;
    }
  }

  void compare(size_t i, const std::vector<std::vector<Hit>>& of_robust,
               const std::vector<std::vector<Hit>>& of_first) {
    BenchRow& row = result_.rows[i];
    for (size_t kind = 0; kind < rays_.size(); ++kind) {
      for (const Feed feed : subjects_[i]->feeds()) {
        const std::vector<Hit> hits = answers(i, rays_of(kind), feed);
        BenchRun run{kind, feed, {}, {}, {}, {}};
        for (const Hit& hit : hits) run.hits += hit ? 1 : 0;
        if (kind < of_robust.size()) run.unlike_robust = count_unlike(hits, of_robust[kind], is_same_answer);
        if (row.engine == BenchEngine::kerf && kind < of_first.size())
          run.unlike_kerf = count_unlike(hits, of_first[kind], std::equal_to<>());
        row.runs.push_back(std::move(run));
      }
    }
  }

  /// Rows take turns, every other time backwards, so that none always comes after the same one; then in building, as
  /// long as there is time for it.
  void time_rows() {
    std::vector<size_t> turns(subjects_.size());
    double seconds = 0;
    for (size_t i = 0; i < turns.size(); ++i) {
      turns[i] = i;
      if (is_there(i)) seconds += result_.rows[i].builds.front();
    }
    for (int run = 0; run < options_.repeat && !is_stopped_; ++run) {
      for (size_t kind = 0; kind < rays_.size(); ++kind) time_kind(turns, kind);
      const bool has_time = run + 1 < kLeastBuilds || seconds * (run + 1) < kSecondsOfBuilding;
      for (const size_t i : turns) {
        if (run > 0 && has_time && is_there(i) && tell("build", result_.rows[i])) build_again(i);
      }
      std::reverse(turns.begin(), turns.end());
    }
  }

  void time_kind(const std::vector<size_t>& turns, size_t kind) {
    for (const size_t i : turns) {
      if (!is_there(i) || !tell("trace", result_.rows[i])) continue;
      within_limits(i, kTooLong, [&] {
        for (BenchRun& run : result_.rows[i].runs) {
          if (run.kind == kind) time(i, run);
        }
      });
      done_ += 1.0 / static_cast<double>(rays_.size());
    }
  }

  void time(size_t i, BenchRun& run) const {
    const std::unique_ptr<BenchPass> pass = subjects_[i]->prepare(rays_of(run.kind), run.feed);
    const auto start = std::chrono::steady_clock::now();
    pass->trace();
    run.seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }

  void build_again(size_t i) {
    try {
      result_.rows[i].builds.push_back(subjects_[i]->time_build(measure_.limit()));
    } catch (const Error& error) {
      if (error.code() != ErrorCode::stopped) throw;
    } catch (const std::bad_alloc&) {  // what is there is kept
    }
  }

  /// Runs that an interrupt left without a time say nothing.
  static void keep_timed(BenchRow& row) {
    std::erase_if(row.runs, [](const BenchRun& run) { return run.seconds.empty(); });
    if (!row.finished || !row.runs.empty()) return;
    row.finished = false;
    row.why_not = "it was interrupted";
  }

  const StudyScene& input_;
  BenchOptions options_;
  RowMeasure measure_;
  BenchScene result_;
  std::vector<StudyRays> rays_;
  std::vector<std::vector<uint32_t>> orders_;            // of each kind
  std::vector<std::unique_ptr<BenchSubject>> subjects_;  // as result_.rows
  double done_ = 0, steps_ = 1;
  bool is_stopped_ = false;
};

}  // namespace

std::vector<std::string> bench_rows() {
  std::vector<std::string> rows;
  for (const PresetEntry& preset : presets()) {
    rows.emplace_back(preset.name);
    for (const std::string_view wide : kWideLayouts) {
      const auto is_it = [&](const MenuEntry& entry) { return entry.name == wide; };
      if (std::any_of(menu().begin(), menu().end(), is_it)) {
        rows.push_back(fmt::format("{}+{}", preset.name, wide));
      }
    }
  }
  return rows;
}

BenchScene bench(const StudyScene& scene, const std::string& turn, const BenchOptions& options) {
  return Bench(scene, turn, options).run();
}

}  // namespace kerf
