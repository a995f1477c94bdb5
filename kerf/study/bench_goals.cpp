#include "kerf/study/bench_goals.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "kerf/study/bench_findings.h"
#include "kerf/study/bench_ratios.h"
#include "kerf/study/spread.h"

namespace kerf {
namespace {

constexpr std::string_view kQuantised = "quantised_";

constexpr double kLeastSingle = 1.25, kLeastOfAnyScene = 0.9, kLeastBesideRobust = 2;
constexpr double kLeastBatch = 1.75, kLeastBesideBestBatch = 1.25;
constexpr double kMostBalancedBuild = 1.5, kLeastBalancedSpeed = 0.95;
constexpr double kLeastOfThreads = 0.97;
constexpr double kGrowthFrom = 1.2e4, kGrowthTo = 0.8e7;  // a family's models have about as many triangles as asked for

constexpr BenchGoal kGoals[] = {
    {"single_diffuse", "single rays, diffuse", "mean 1.25 times HIGH"},
    {"single_shadow", "single rays, shadow", "mean 1.25 times HIGH"},
    {"single_primary", "single rays, primary", "mean 1.25 times HIGH"},
    {"single_least", "single rays, any scene", "no kind on any scene below 0.9 times HIGH"},
    {"robust", "single rays, robust", "mean of each kind 2 times ROBUST HIGH"},
    {"batch_diffuse", "batches, diffuse", "mean 1.75 times HIGH's single rays"},
    {"batch_shadow", "batches, shadow", "mean 1.75 times HIGH's single rays"},
    {"batch_best", "batches, fed as well",
     "diffuse and shadow: mean 1.25 times the best of HIGH fed sorted, in packets of "
     "8 and 16 and as a stream"},
    {"build_balanced", "build, balanced", "mean at most 1.5 R times MEDIUM, with 0.95 of HIGH's ray speed"},
    {"build_best", "build, best", "mean no slower than HIGH"},
    {"build_fast", "build, fast", "mean faster than MEDIUM"},
    {"bytes", "bytes per reference", "the judged row's mean at most HIGH's"},
    {"bytes_quantised", "bytes, quantised",
     "0.6 of HIGH's bytes per reference at 90 % of the full layout's ray speed, 0.5 at 80 %, on sanmiguel and "
     "tower_bridge"},
    {"threads_rays", "two threads, rays", "no kind gains less than HIGH does, less 3 %"},
    {"threads_builds", "two threads, builds",
     "balanced gains no less than MEDIUM does, best no less than HIGH, less 3 %"},
    {"growth", "growth", "from 1e4 to 1e7 triangles of one family Mray/s falls no faster than HIGH's"},
    {"hits", "hits",
     "beside Embree's robust scene nothing is unexplained; all rows of Kerf's find the same, bit for bit"},
    {"watertight", "watertight", "as many instructions per node as a kernel that is not"},
};

/// Everything that is judged together.
class Judge {
 public:
  explicit Judge(std::span<const BenchScene> scenes) : all_(scenes) {
    for (const BenchScene& scene : scenes) {
      if (scene.threads == 1 && scene.family.empty()) alone_.push_back(scene);
    }
    single_ = judged_row(alone_, Feed::loop);
    batch_ = judged_row(alone_, Feed::batch);
  }

  std::vector<BenchFinding> findings() const {
    return {single("diffuse"), single("shadow"), single("primary"),
            single_least(),    robust(),         batch("diffuse"),
            batch("shadow"),   batch_best(),     build_balanced(),
            build_best(),      build_fast(),     bytes(),
            bytes_quantised(), threads_rays(),   threads_builds(),
            growth(),          hits(),           not_measured("kerf bench counts no instructions")};
  }

 private:
  BenchFinding beside(std::string_view quality, const std::string& row, Feed feed, const char* kind, double bar) const {
    if (row.empty()) return not_measured(nothing());
    const BenchColumn column =
        column_of(alone_, [&](const BenchScene& scene) { return ratio_to(scene, quality, row, feed, kind); });
    BenchFinding finding = mean_at_least(column, bar, row);
    if (column.values.empty()) finding.text = fmt::format("{} rays: {}", kind, finding.text);
    return finding;
  }
  BenchFinding single(const char* kind) const { return beside("high", single_, Feed::loop, kind, kLeastSingle); }
  BenchFinding batch(const char* kind) const { return beside("high", batch_, Feed::batch, kind, kLeastBatch); }

  std::string nothing() const {
    return alone_.empty() ? "there is no scene with one thread" : "no row of Kerf's and of Embree's HIGH to compare";
  }

  BenchFinding robust() const {
    std::vector<BenchFinding> kinds;
    for (const char* kind : {"diffuse", "shadow", "primary"}) {
      kinds.push_back(beside("robust", single_, Feed::loop, kind, kLeastBesideRobust));
      kinds.back().text = fmt::format("{} {}", kind, kinds.back().text);
    }
    return all_of(kinds);
  }

  BenchFinding single_least() const {
    if (single_.empty()) return not_measured(nothing());
    std::string where;
    const BenchColumn column = column_of(alone_, [&](const BenchScene& scene) {
      double least = kUnknown;
      for (const char* kind : {"diffuse", "shadow", "primary"}) {
        const double ratio = ratio_to(scene, "high", single_, Feed::loop, kind);
        if (std::isnan(ratio)) return kUnknown;
        least = std::fmin(least, ratio);
      }
      return least;
    });
    return with_all(column, column.least, column.least >= kLeastOfAnyScene,
                    fmt::format("{:.3f}x ({})", column.least, column.least_scene));
  }

  /// Kerf's batches beside the fastest way to feed HIGH, chosen scene by scene.
  BenchFinding batch_best() const {
    if (batch_.empty()) return not_measured(nothing());
    std::vector<BenchFinding> kinds;
    for (const char* kind : {"diffuse", "shadow"}) {
      const BenchColumn column = column_of(alone_, [&](const BenchScene& scene) {
        const BenchRow *high = scene.embree("high"), *row = scene.row(batch_);
        const std::optional<size_t> number = kind_number(scene, kind);
        if (high == nullptr || row == nullptr || !number) return kUnknown;
        double least = kUnknown;
        for (const Feed feed : {Feed::sorted, Feed::packets_8, Feed::packets_16, Feed::stream}) {
          least = std::fmin(least, speed_ratio(high->run(*number, feed), row->run(*number, Feed::batch)));
        }
        return least;
      });
      kinds.push_back(mean_at_least(column, kLeastBesideBestBatch, batch_));
      kinds.back().text = fmt::format("{} {}", kind, kinds.back().text);
    }
    return all_of(kinds);
  }

  /// Build seconds of a preset over those of a quality; `divisor` of Kerf's row.
  BenchColumn build_column(const std::string& preset, std::string_view quality,
                           const std::function<double(const BenchRow&)>& divisor) const {
    const std::string name = best_row(alone_, preset, Feed::loop);
    return column_of(alone_, [&](const BenchScene& scene) {
      const BenchRow *row = scene.row(name), *base = scene.embree(quality);
      return row != nullptr ? build_seconds(row) / build_seconds(base) / divisor(*row) : kUnknown;
    });
  }

  BenchFinding build_balanced() const {
    const std::string name = best_row(alone_, "balanced", Feed::loop);
    if (name.empty()) return not_measured(nothing());
    const BenchColumn column = column_of(alone_, [&](const BenchScene& scene) {
      const BenchRow* row = scene.row(name);
      if (row == nullptr || scene.triangles == 0) return kUnknown;
      const double r = std::max(1.0, row->references.value_or(kUnknown) / static_cast<double>(scene.triangles));
      return build_seconds(row) / build_seconds(scene.embree("medium")) / r;
    });
    const double speed = overall_ratio(alone_, name, Feed::loop);
    BenchFinding build = mean_at_most(column, kMostBalancedBuild, name + ", over R");
    BenchFinding rays{reached_if(speed >= kLeastBalancedSpeed), speed, fmt::format("rays {:.3f}x HIGH", speed)};
    return all_of({build, rays});
  }

  BenchFinding build_best() const {
    const BenchColumn column = build_column("best", "high", [](const BenchRow&) { return 1.0; });
    return mean_at_most(column, 1, "of HIGH's time");
  }

  BenchFinding build_fast() const {
    const BenchColumn column = build_column("fast", "medium", [](const BenchRow&) { return 1.0; });
    return mean_at_most(column, 1, "of MEDIUM's time", true);
  }

  static double bytes_per_reference(const BenchRow* row) {
    return row != nullptr && row->references && *row->references > 0
               ? static_cast<double>(row->bytes) / *row->references
               : kUnknown;
  }
  static double bytes_share(const BenchScene& scene, const std::string& name) {
    return bytes_per_reference(scene.row(name)) / bytes_per_reference(scene.embree("high"));
  }

  BenchFinding bytes() const {
    if (single_.empty()) return not_measured(nothing());
    return mean_at_most(column_of(alone_, [&](const BenchScene& scene) { return bytes_share(scene, single_); }), 1,
                        single_ + ", of HIGH's");
  }

  /// The judged row, or where that is of a quantised layout the one that this is the small form of.
  std::string full_form() const {
    const size_t at = single_.find(kQuantised);
    return at == std::string::npos ? single_ : std::string(single_).erase(at, kQuantised.size());
  }
  /// As another row, but the layout "quantised_", or with something behind its name.
  static bool is_small_form(const std::string& name, const std::string& full) {
    if (full.empty() || name == full) return false;
    return name.starts_with(full) || name == std::string(full).insert(full.rfind(' ') + 1, kQuantised);
  }

  /// A row of the judged preset with a small form of the judged one's layout.
  BenchFinding bytes_quantised() const {
    std::vector<BenchScene> asked;
    for (const BenchScene& scene : alone_) {
      if (scene.name.starts_with("sanmiguel") || scene.name.starts_with("tower_bridge")) asked.push_back(scene);
    }
    if (asked.empty()) return not_measured("neither sanmiguel nor tower_bridge was measured with one thread");
    const std::string full_name = full_form();
    const double full = overall_ratio(asked, full_name, Feed::loop);
    bool at_60 = false, at_50 = false;
    std::string text;
    for (const std::string& name : kerf_rows(asked, "")) {
      if (!is_small_form(name, full_name)) continue;
      const BenchColumn share = column_of(asked, [&](const BenchScene& scene) { return bytes_share(scene, name); });
      const double speed = overall_ratio(asked, name, Feed::loop) / full;
      if (share.missing() > 0 || std::isnan(speed)) continue;
      at_60 |= share.mean() <= 0.6 && speed >= 0.9;
      at_50 |= share.mean() <= 0.5 && speed >= 0.8;
      text += fmt::format("{}{}: {:.3f} of HIGH's bytes at {:.3f} of the speed", text.empty() ? "" : "; ", name,
                          share.mean(), speed);
    }
    if (text.empty()) return not_measured("no quantised layout was measured");
    return {reached_if(at_60 && at_50), kUnknown, text};
  }

  /// Calls f(one, two) for each scene that was measured with one thread and with two.
  template <class F>
  void with_pairs(F&& f) const {
    for (const BenchScene& one : all_) {
      for (const BenchScene& two : all_) {
        if (one.threads == 1 && two.threads == 2 && one.title() == two.title() && one.family == two.family) f(one, two);
      }
    }
  }

  /// Kerf's gains from the second thread over Embree's: each scene's, then the mean.
  static BenchFinding gains(const std::vector<double>& values, const char* what) {
    const double mean = geometric_mean(values);
    if (std::isnan(mean)) return not_measured("no scene was measured with --threads 1,2");
    return {reached_if(mean >= kLeastOfThreads), mean, fmt::format("{} {:.3f} of Embree's gain", what, mean)};
  }

  static double median_ratio(const BenchRun* one, const BenchRun* two) {
    return one != nullptr && two != nullptr ? median_of(one->seconds) / median_of(two->seconds) : kUnknown;
  }

  BenchFinding threads_rays() const {
    std::vector<BenchFinding> kinds;
    for (const char* kind : {"diffuse", "shadow", "primary"}) {
      std::vector<double> values;
      with_pairs([&](const BenchScene& one, const BenchScene& two) {
        const BenchRow *a = one.row(single_), *b = two.row(single_), *c = one.embree("high"), *d = two.embree("high");
        const std::optional<size_t> number = kind_number(one, kind);
        if (a == nullptr || b == nullptr || c == nullptr || d == nullptr || !number) return;
        values.push_back(median_ratio(a->run(*number, Feed::loop), b->run(*number, Feed::loop)) /
                         median_ratio(c->run(*number, Feed::loop), d->run(*number, Feed::loop)));
      });
      kinds.push_back(gains(values, kind));
    }
    return all_of(kinds);
  }

  BenchFinding threads_build(const char* preset, std::string_view quality) const {
    const std::string name = best_row(alone_, preset, Feed::loop);
    std::vector<double> values;
    with_pairs([&](const BenchScene& one, const BenchScene& two) {
      const double gain = build_seconds(one.row(name)) / build_seconds(two.row(name));
      const double other = build_seconds(one.embree(quality)) / build_seconds(two.embree(quality));
      if (!std::isnan(gain / other)) values.push_back(gain / other);
    });
    return gains(values, preset);
  }
  BenchFinding threads_builds() const {
    return all_of({threads_build("balanced", "medium"), threads_build("best", "high")});
  }

  /// From the smallest to the largest model of each family, all kinds together.
  BenchFinding growth() const {
    std::vector<BenchScene> models;
    for (const BenchScene& scene : all_) {
      if (scene.threads == 1 && !scene.family.empty()) models.push_back(scene);
    }
    std::sort(models.begin(), models.end(), [](const auto& a, const auto& b) { return a.triangles < b.triangles; });
    if (models.size() < 2) return not_measured("no family was measured: --growth");
    const std::string row = judged_row(models, Feed::loop);
    const double share = overall_ratio(std::span(&models.back(), 1), row, Feed::loop) /
                         overall_ratio(std::span(&models.front(), 1), row, Feed::loop);
    if (std::isnan(share)) return not_measured("it is not known for the smallest and the largest");
    const auto least = static_cast<double>(models.front().triangles),
               most = static_cast<double>(models.back().triangles);
    BenchFinding finding{reached_if(share >= 1), share,
                         fmt::format("{} from {} to {} triangles: the ratio to HIGH grows {:.3f}x", row,
                                     models.front().triangles, models.back().triangles, share)};
    if (finding.state == GoalState::reached && !(least <= kGrowthFrom && most >= kGrowthTo)) {
      finding.state = GoalState::not_measured;
    }
    return finding;
  }

  /// With every number of threads.
  BenchFinding hits() const {
    size_t rays = 0, unexplained = 0, unlike = 0;
    for (const BenchScene& scene : all_) {
      for (const BenchVerdicts& verdicts : scene.verdicts) {
        for (const size_t count : verdicts.counts) rays += count;
        unexplained += verdicts.counts[static_cast<size_t>(Verdict::unexplained)];
      }
      for (const BenchRow& row : scene.rows) {
        for (const BenchRun& run : row.runs) unlike += run.unlike_kerf.value_or(0);
      }
    }
    if (rays == 0) return not_measured("nothing was compared with Embree's robust scene");
    return {reached_if(unexplained + unlike == 0), static_cast<double>(unexplained + unlike),
            fmt::format("{} rays: {} unexplained, {} unlike the first row", rays, unexplained, unlike)};
  }

  std::span<const BenchScene> all_;
  std::vector<BenchScene> alone_;  // one thread, no families
  std::string single_, batch_;
};

}  // namespace

std::span<const BenchGoal> bench_goals() { return kGoals; }

std::vector<BenchVerdict> bench_verdicts(std::span<const BenchScene> scenes) {
  std::vector<BenchFinding> findings = Judge(scenes).findings();
  std::vector<BenchVerdict> verdicts;
  for (size_t i = 0; i < std::size(kGoals); ++i) {
    verdicts.push_back({&kGoals[i], findings[i].state, findings[i].measured, std::move(findings[i].text)});
  }
  return verdicts;
}

}  // namespace kerf
