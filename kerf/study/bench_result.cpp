#include "kerf/study/bench_result.h"

#include <algorithm>
#include <limits>

#include "kerf/study/spread.h"

namespace kerf {
namespace {

constexpr FeedEntry kFeeds[] = {
    {Feed::loop, "loop", "single", "one call for each ray, in the caller's order"},
    {Feed::batch, "batch", "batch", "one call for all rays in the caller's order; sorting, if any, is in its time"},
    {Feed::sorted, "sorted", "batch", "one call for each ray, of rays that were sorted before the clock starts"},
    {Feed::packets_8, "packets_8", "batch", "packets of 8 of those"},
    {Feed::packets_16, "packets_16", "batch", "packets of 16 of those"},
    {Feed::stream, "stream", "batch", "streams of those"},
};

}  // namespace

std::string_view engine_name(BenchEngine engine) { return engine == BenchEngine::kerf ? "kerf" : "embree"; }

std::span<const FeedEntry> feeds() { return kFeeds; }
const FeedEntry& feed_entry(Feed feed) { return kFeeds[static_cast<size_t>(feed)]; }

const BenchRun* BenchRow::run(size_t kind, Feed feed) const {
  const auto found =
      std::find_if(runs.begin(), runs.end(), [&](const BenchRun& r) { return r.kind == kind && r.feed == feed; });
  return found != runs.end() ? &*found : nullptr;
}

const BenchRow* BenchScene::embree(std::string_view quality) const {
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const BenchRow& r) {
    return r.engine == BenchEngine::embree && r.quality == quality && r.finished;
  });
  return found != rows.end() ? &*found : nullptr;
}

const BenchRow* BenchScene::row(std::string_view wanted) const {
  const auto found =
      std::find_if(rows.begin(), rows.end(), [&](const BenchRow& r) { return r.finished && r.name() == wanted; });
  return found != rows.end() ? &*found : nullptr;
}

double BenchScene::mrays(const BenchRun& run) const {
  return static_cast<double>(ray_counts[run.kind]) / median_of(run.seconds) / 1e6;
}

double speed_ratio(const BenchRun* base, const BenchRun* run) {
  std::vector<double> ratios;
  if (base != nullptr && run != nullptr) {
    for (size_t i = 0; i < std::min(base->seconds.size(), run->seconds.size()); ++i) {
      ratios.push_back(base->seconds[i] / run->seconds[i]);
    }
  }
  return median_of(std::move(ratios));
}

double build_seconds(const BenchRow* row) {
  return row != nullptr ? median_of(row->builds) : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace kerf
