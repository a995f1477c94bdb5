#include "kerf/study/bench_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "kerf/study/bench_goals.h"
#include "kerf/study/bench_ratios.h"
#include "kerf/study/spread.h"
#include "kerf/study/tables.h"

namespace kerf {
namespace {

constexpr size_t kFeedWidth = 11, kKindWidth = 20, kGoalWidth = 22, kStateWidth = 12, kLeastName = 14;

/// A row in few words: "balanced bvh2", "EMBREE HIGH".
std::string short_name(const BenchRow& row) {
  if (row.engine == BenchEngine::kerf) return row.quality + " " + row.layout;
  std::string name = "Embree " + row.quality;
  std::transform(name.begin() + 7, name.end(), name.begin() + 7,
                 [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
  return name;
}

size_t name_width(std::span<const BenchScene> scenes) {
  size_t width = kLeastName;
  for (const BenchScene& scene : scenes) {
    for (const BenchRow& row : scene.rows) width = std::max(width, short_name(row).size());
  }
  return width;
}

std::string number_text(double x, int digits) { return std::isnan(x) ? "-" : fmt::format("{:.{}f}", x, digits); }

/// "3.21 +-2 % 1.05x": Mray/s, half the spread of its runs, and how many times as fast as Embree's high quality.
std::string speed_text(const BenchScene& scene, const BenchRun* run) {
  if (run == nullptr) return "-";
  const Spread spread = spread_of(run->seconds);
  const BenchRow* high = scene.embree("high");
  const double ratio = speed_ratio(high != nullptr ? high->run(run->kind, Feed::loop) : nullptr, run);
  return fmt::format("{:.3f} +-{:.0f} %{}", scene.mrays(*run), 50 * (spread.most - spread.least) / spread.median,
                     std::isnan(ratio) ? "" : fmt::format(" {:.2f}x", ratio));
}

/// "0 0 3": of each kind of rays how many answers are unlike the robust ones; empty where that is not known.
std::string unlike_text(const BenchScene& scene, const BenchRow& row, Feed feed) {
  std::string text;
  for (size_t kind = 0; kind < scene.kinds.size(); ++kind) {
    const BenchRun* run = row.run(kind, feed);
    if (run == nullptr || !run->unlike_robust) return "";
    text += fmt::format("{}{}", kind > 0 ? " " : "", *run->unlike_robust);
    if (run->unlike_kerf.value_or(0) > 0) text += fmt::format(" ({} UNLIKE THE FIRST ROW)", *run->unlike_kerf);
  }
  return text;
}

std::string heading(const BenchScene& scene, size_t width) {
  std::string rays;
  for (size_t k = 0; k < scene.kinds.size(); ++k) {
    rays += fmt::format("{}{} {}", k > 0 ? ", " : "", scene.ray_counts[k], scene.kinds[k]);
  }
  std::string text = fmt::format("{}: {} triangles; {} thread{}; rays: {}\n", scene.title(), scene.triangles,
                                 scene.threads, scene.threads == 1 ? "" : "s", rays);
  if (!scene.rival.empty()) text += scene.rival + "\n";
  text += fmt::format("{:<{}} {:<{}} {:>7} {:>8} {:>6} {:>8}", "", width, "", kFeedWidth, "isa", "bytes", "B/ref",
                      "T_build");
  for (const std::string& kind : scene.kinds) text += fmt::format("  {:>{}}", kind, kKindWidth);
  return text + "  unlike robust\n";
}

std::string row_lines(const BenchScene& scene, const BenchRow& row, size_t width) {
  if (!row.finished) return fmt::format("{:<{}} not finished: {}\n", short_name(row), width, row.why_not);
  std::string text;
  for (const FeedEntry& entry : feeds()) {
    const auto is_fed = [&](const BenchRun& run) { return run.feed == entry.feed; };
    if (std::none_of(row.runs.begin(), row.runs.end(), is_fed)) continue;
    const bool is_first = text.empty();
    text += fmt::format("{:<{}} {:<{}}", is_first ? short_name(row) : "", width, entry.name, kFeedWidth);
    if (is_first) {
      const double per_reference = row.references ? static_cast<double>(row.bytes) / *row.references : NAN;
      text += fmt::format(" {:>7} {:>8} {:>6} {:>8}", row.isa, bytes_text(row.bytes), number_text(per_reference, 1),
                          number_text(build_seconds(&row), 4));
    } else {
      text += std::string(33, ' ');
    }
    for (size_t k = 0; k < scene.kinds.size(); ++k) {
      text += fmt::format("  {:>{}}", speed_text(scene, row.run(k, entry.feed)), kKindWidth);
    }
    text += "  " + unlike_text(scene, row, entry.feed) + "\n";
  }
  return text + room_line(row.short_of_room);
}

/// What Kerf finds beside Embree's robust scene, kind by kind.
std::string verdict_lines(const BenchScene& scene) {
  std::string text;
  for (size_t kind = 0; kind < scene.verdicts.size(); ++kind) {
    const BenchVerdicts& verdicts = scene.verdicts[kind];
    text += fmt::format("  {}: ", scene.kinds[kind]);
    for (int v = 0; v < kVerdicts; ++v) {
      text += fmt::format("{}{} {}", v > 0 ? ", " : "", verdicts.counts[static_cast<size_t>(v)],
                          verdict_name(static_cast<Verdict>(v)));
    }
    text += verdicts.not_judged > 0 ? fmt::format(", {} not judged\n", verdicts.not_judged) : "\n";
  }
  return text.empty() ? "" : "closest hits beside Embree ROBUST, judged in extended precision:\n" + text;
}

std::string builders(const BenchScene& scene) {
  std::string text;
  for (const BenchRow& row : scene.rows) {
    if (!row.finished) continue;
    text += fmt::format("  {}: {}{}\n", short_name(row), row.builder,
                        row.engine == BenchEngine::embree ? ", " + row.layout : "");
  }
  return text;
}

/// The rows of the first scene, with their means over all.
std::string means(std::span<const BenchScene> scenes, size_t width) {
  std::string text = fmt::format("{:<{}} {:<{}}", "", width, "", kFeedWidth);
  for (const std::string& kind : scenes[0].kinds) text += fmt::format("  {:>{}}", kind, 9);
  text += "\n";
  for (const BenchRow& row : scenes[0].rows) {
    for (const FeedEntry& entry : feeds()) {
      if (row.run(0, entry.feed) == nullptr) continue;
      text += fmt::format("{:<{}} {:<{}}", short_name(row), width, entry.name, kFeedWidth);
      for (const std::string& kind : scenes[0].kinds) {
        const double ratio = mean_ratio(scenes, row.name(), entry.feed, kind);
        text += fmt::format("  {:>{}}", std::isnan(ratio) ? "-" : fmt::format("{:.3f}x", ratio), 9);
      }
      text += "\n";
    }
  }
  return text;
}

std::vector<BenchScene> with_threads_of_first(std::span<const BenchScene> scenes) {
  std::vector<BenchScene> alike;
  for (const BenchScene& scene : scenes) {
    if (scene.threads == scenes[0].threads) alike.push_back(scene);
  }
  return alike;
}

}  // namespace

std::string bench_text(std::span<const BenchScene> scenes) {
  if (scenes.empty()) return "";
  const size_t width = name_width(scenes);
  std::string text =
      "Mray/s (medians), half the spread of the runs, times Embree HIGH one ray at a time; T_build in seconds\n\n";
  for (const BenchScene& scene : scenes) {
    text += heading(scene, width);
    for (const BenchRow& row : scene.rows) text += row_lines(scene, row, width);
    text += verdict_lines(scene) + "built by:\n" + builders(scene) + "\n";
  }
  if (scenes[0].rival.empty()) return text;
  const std::vector<BenchScene> alike = with_threads_of_first(scenes);
  if (alike.size() > 1) {
    text += fmt::format("times Embree HIGH one ray at a time, geometric means over {} scenes, threads: {}\n",
                        alike.size(), alike[0].threads) +
            means(alike, width) + "\n";
  }
  text += "goals:\n";
  for (const BenchVerdict& verdict : bench_verdicts(scenes)) {
    text += fmt::format("  {:<{}} {:<{}} {}: {}\n", verdict.goal->name, kGoalWidth, state_name(verdict.state),
                        kStateWidth, verdict.goal->bar, verdict.text);
  }
  return text;
}

}  // namespace kerf
