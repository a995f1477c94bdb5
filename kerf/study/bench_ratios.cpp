#include "kerf/study/bench_ratios.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kerf/study/spread.h"

namespace kerf {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// The names of the kinds of rays that any scene has.
std::vector<std::string> kinds_of(std::span<const BenchScene> scenes) {
  std::vector<std::string> kinds;
  for (const BenchScene& scene : scenes) {
    for (const std::string& kind : scene.kinds) {
      if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) kinds.push_back(kind);
    }
  }
  return kinds;
}

}  // namespace

std::optional<size_t> kind_number(const BenchScene& scene, std::string_view kind) {
  const auto found = std::find(scene.kinds.begin(), scene.kinds.end(), kind);
  if (found == scene.kinds.end()) return std::nullopt;
  const auto number = static_cast<size_t>(found - scene.kinds.begin());
  return scene.ray_counts[number] > 0 ? std::optional(number) : std::nullopt;
}

double ratio_to(const BenchScene& scene, std::string_view quality, std::string_view row_name, Feed feed,
                std::string_view kind) {
  const BenchRow *base = scene.embree(quality), *row = scene.row(row_name);
  const std::optional<size_t> number = kind_number(scene, kind);
  if (base == nullptr || row == nullptr || !number) return kUnknown;
  return speed_ratio(base->run(*number, Feed::loop), row->run(*number, feed));
}

double overall_ratio(std::span<const BenchScene> scenes, std::string_view row, Feed feed) {
  std::vector<double> values;
  for (const std::string& kind : kinds_of(scenes)) {
    for (const BenchScene& scene : scenes) {
      const double ratio = ratio_to(scene, "high", row, feed, kind);
      if (!std::isnan(ratio)) values.push_back(ratio);
    }
  }
  return geometric_mean(values);
}

std::vector<std::string> kerf_rows(std::span<const BenchScene> scenes, std::string_view quality) {
  std::vector<std::string> names;
  for (const BenchScene& scene : scenes) {
    for (const BenchRow& row : scene.rows) {
      if (row.engine != BenchEngine::kerf || (!quality.empty() && row.quality != quality)) continue;
      if (std::find(names.begin(), names.end(), row.name()) == names.end()) names.push_back(row.name());
    }
  }
  return names;
}

std::string best_row(std::span<const BenchScene> scenes, std::string_view quality, Feed feed) {
  std::string best;
  double most = 0;
  for (const std::string& name : kerf_rows(scenes, quality)) {
    const double ratio = overall_ratio(scenes, name, feed);
    if (!(ratio > most)) continue;
    most = ratio;
    best = name;
  }
  return best;
}

std::string judged_row(std::span<const BenchScene> scenes, Feed feed) {
  const std::string best = best_row(scenes, "best", feed);
  return best.empty() ? best_row(scenes, "", feed) : best;
}

double mean_ratio(std::span<const BenchScene> scenes, std::string_view row, Feed feed, std::string_view kind) {
  std::vector<double> values;
  for (const BenchScene& scene : scenes) values.push_back(ratio_to(scene, "high", row, feed, kind));
  return geometric_mean(values);
}

}  // namespace kerf
