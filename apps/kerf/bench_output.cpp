#include "apps/kerf/bench_output.h"

#include <cmath>

#include "kerf/study/spread.h"

namespace kerf::app {
namespace {

using Json = nlohmann::ordered_json;

Json number_json(double x) { return std::isfinite(x) ? Json(x) : Json(); }
Json count_json(const std::optional<size_t>& count) { return count ? Json(*count) : Json(); }

/// Mray/s of the slowest and the fastest run.
Json spread_json(const BenchScene& scene, const BenchRun& run) {
  const Spread seconds = spread_of(run.seconds);
  const auto rays = static_cast<double>(scene.ray_counts[run.kind]);
  return {{"least", number_json(rays / seconds.most / 1e6)},
          {"most", number_json(rays / seconds.least / 1e6)},
          {"count", seconds.count}};
}

Json build_spread_json(const BenchRow& row) {
  const Spread spread = spread_of(row.builds);
  return {{"least", spread.least}, {"most", spread.most}, {"count", spread.count}};
}

/// What is known of a row before it is built.
Json head_json(const BenchScene& scene, const BenchRow& row, size_t kind, Feed feed) {
  const FeedEntry& entry = feed_entry(feed);
  return {{"scene", scene.name},
          {"turn", scene.turn},
          {"triangles", scene.triangles},
          {"threads", scene.threads},
          {"engine", engine_name(row.engine)},
          {"quality", row.quality},
          {"layout", row.layout},
          {"isa", row.isa},
          {"builder", row.builder},
          {"rays", scene.kinds[kind]},
          {"ray_count", scene.ray_counts[kind]},
          {"mode", entry.mode},
          {"feed", entry.name},
          {"finished", row.finished}};
}

/// Of a row of Kerf's whose hits are those that were judged.
Json verdicts_json(const BenchScene& scene, const BenchRun& run) {
  if (run.kind >= scene.verdicts.size() || run.unlike_kerf != size_t{0}) return {};
  const BenchVerdicts& verdicts = scene.verdicts[run.kind];
  Json one = {{"not judged", verdicts.not_judged}};
  for (int v = 0; v < kVerdicts; ++v) {
    one[verdict_name(static_cast<Verdict>(v))] = verdicts.counts[static_cast<size_t>(v)];
  }
  return one;
}

Json run_json(const BenchScene& scene, const BenchRow& row, const BenchRun& run) {
  const BenchRow* high = scene.embree("high");
  Json one = head_json(scene, row, run.kind, run.feed);
  one.update({{"mrays_per_second", number_json(scene.mrays(run))},
              {"mrays_spread", spread_json(scene, run)},
              {"ratio_to_embree_high",
               number_json(speed_ratio(high != nullptr ? high->run(run.kind, Feed::loop) : nullptr, &run))},
              {"build_seconds", number_json(build_seconds(&row))},
              {"build_seconds_spread", build_spread_json(row)},
              {"bytes", row.bytes},
              {"references", row.references ? Json(std::round(*row.references)) : Json()},
              {"short_of_room", row.engine == BenchEngine::kerf ? Json(row.short_of_room) : Json()},
              {"hits", run.hits},
              {"unlike_robust", count_json(run.unlike_robust)},
              {"unlike_kerf", count_json(run.unlike_kerf)},
              {"verdicts", verdicts_json(scene, run)},
              {"settings", row.engine == BenchEngine::embree ? Json(scene.rival) : Json()}});
  return one;
}

Json unfinished_json(const BenchScene& scene, const BenchRow& row, size_t kind) {
  Json one = head_json(scene, row, kind, Feed::loop);
  one["why_not"] = row.why_not;
  for (const char* key :
       {"mrays_per_second", "mrays_spread", "ratio_to_embree_high", "build_seconds", "build_seconds_spread", "bytes",
        "references", "short_of_room", "hits", "unlike_robust", "unlike_kerf", "verdicts", "settings"}) {
    one[key] = nullptr;
  }
  return one;
}

}  // namespace

Json bench_json(std::span<const BenchScene> scenes) {
  Json all = Json::array();
  for (const BenchScene& scene : scenes) {
    for (const BenchRow& row : scene.rows) {
      for (size_t kind = 0; kind < scene.kinds.size(); ++kind) {
        if (!row.finished) all.push_back(unfinished_json(scene, row, kind));
        for (const BenchRun& run : row.runs) {
          if (row.finished && run.kind == kind) all.push_back(run_json(scene, row, run));
        }
      }
    }
  }
  return all;
}

}  // namespace kerf::app
