#include "apps/kerf/study_output.h"

#include <fmt/chrono.h>
#include <fmt/core.h>

#include <ctime>
#include <fstream>
#include <thread>

#include "apps/kerf/scene_input.h"
#include "kerf/base/version.h"
#include "kerf/io/output_file.h"
#include "kerf/study/splitting_goals.h"
#include "kerf/study/splitting_tables.h"
#include "kerf/study/spread.h"

namespace kerf::app {
namespace {

using Json = nlohmann::ordered_json;

Json spread_json(const Spread& spread) {
  return {{"least", spread.least}, {"most", spread.most}, {"count", spread.count}};
}

Json paper_json(const PaperRow& paper) {
  return {{"references_per_triangle", paper.references_per_triangle},
          {"build_seconds", paper.build_seconds},
          {"nodes_per_ray", paper.nodes_per_ray},
          {"triangles_per_ray", paper.triangles_per_ray},
          {"trace_seconds", paper.trace_seconds},
          {"speedup", paper.speedup}};
}

Json seconds_json(const BuildReport::Seconds& seconds) { return {{"split", seconds.split}, {"total", seconds.total}}; }

Json row_json(const SplittingScene& scene, const SplittingRow& row) {
  Json one = {{"row", row_name(row)}, {"pipeline", row.pipeline}, {"finished", row.finished}};
  if (!row.finished) {
    one["why_not"] = row.why_not;
    return one;
  }
  one.update({{"references_per_primitive", row.references_per_primitive},
              {"sah_cost", row.sah_cost},
              {"bytes", row.bytes},
              {"peak_bytes", row.peak_bytes ? Json(*row.peak_bytes) : Json()},
              {"tree_hash", fmt::format("{:016x}", row.tree_hash)},
              {"split_choice", choice_json(row.choice)},
              {"short_of_room", row.short_of_room},
              {"builds", Json::array()},
              {"rays", Json::array()}});
  for (const BuildReport::Seconds& seconds : row.builds) one["builds"].push_back(seconds_json(seconds));
  const SplittingRow* plain = scene.row(SplittingRole::plain);
  for (size_t k = 0; k < row.rays.size(); ++k) {
    const SplittingRow::Rays& rays = row.rays[k];
    Json kind = {{"rays", scene.kinds[k]},
                 {"nodes_per_ray", rays.nodes},
                 {"triangles_per_ray", rays.triangles},
                 {"visits_of_plain", visits_share(scene, row, k)},
                 {"hits", rays.hits},
                 {"trace_seconds", rays.seconds}};
    const std::vector<double> speeds = plain != nullptr ? paired_speeds(*plain, row, k) : std::vector<double>();
    const std::optional<Interval> interval = median_interval(speeds);
    kind["speed"] = speeds.empty() ? Json() : Json(median_of(speeds));
    kind["speed_interval"] = interval ? Json({interval->lower, interval->upper}) : Json();
    one["rays"].push_back(std::move(kind));
  }
  return one;
}

Json goals_json(std::span<const GoalVerdict> verdicts) {
  Json all = Json::array();
  for (const GoalVerdict& verdict : verdicts) {
    all.push_back({{"goal", verdict.goal->id},
                   {"bar", verdict.goal->bar},
                   {"state", state_name(verdict.state)},
                   {"measured", verdict.measured},
                   {"text", verdict.text}});
  }
  return all;
}

Json scene_json(const SplittingScene& scene) {
  Json one = {{"scene", scene.name},    {"turn", scene.turn},      {"triangles", scene.triangles},
              {"rays", Json::array()},  {"rows", Json::array()},   {"variants", Json::array()},
              {"trees", Json::array()}, {"skipped", scene.skipped}};
  for (size_t k = 0; k < scene.kinds.size(); ++k) {
    one["rays"].push_back({{"rays", scene.kinds[k]}, {"ray_count", scene.ray_counts[k]}});
  }
  for (const SplittingRow& row : scene.rows) one["rows"].push_back(row_json(scene, row));
  for (const SplittingVariant& variant : scene.variants) {
    one["variants"].push_back({{"what", variant.what}, {"references_per_primitive", variant.references_per_primitive}});
  }
  for (const SplittingTrees& trees : scene.trees) {
    Json hashes = Json::array();
    for (const uint64_t hash : trees.hashes) hashes.push_back(fmt::format("{:016x}", hash));
    one["trees"].push_back(
        {{"row", splitting_row(trees.role).name}, {"threads", trees.threads}, {"tree_hashes", std::move(hashes)}});
  }
  one["capped_references_per_primitive"] = scene.capped_references ? Json(*scene.capped_references) : Json();
  one["goals"] = goals_json(scene_verdicts(scene));
  return one;
}

}  // namespace

Json splitting_json(std::span<const SplittingScene> scenes) {
  Json all = {{"scenes", Json::array()}, {"goals", goals_json(overall_verdicts(scenes))}};
  for (const SplittingScene& scene : scenes) all["scenes"].push_back(scene_json(scene));
  return all;
}

Json study_json(std::span<const StudyResult> results) {
  Json all = Json::array();
  for (const StudyResult& r : results) {
    Json one = {{"scene", r.scene}, {"triangles", r.triangles}, {"row", r.row},
                {"rays", r.rays},   {"ray_count", r.ray_count}, {"finished", r.finished}};
    if (!r.finished) {
      one["why_not"] = r.why_not;
      for (const char* key :
           {"references_per_triangle", "sa_max", "build_seconds", "nodes_per_ray", "triangles_per_ray", "boxes_per_ray",
            "trace_seconds", "speedup", "bytes", "depth", "sah_cost", "end_point_overlap", "hits", "short_of_room"}) {
        one[key] = nullptr;
      }
      all.push_back(std::move(one));
      continue;
    }
    one.update({{"references_per_triangle", r.references_per_triangle},
                {"sa_max", limit_json(r.sa_max)},
                {"build_seconds", r.build_seconds.median},
                {"build_seconds_spread", spread_json(r.build_seconds)},
                {"nodes_per_ray", r.nodes_per_ray},
                {"triangles_per_ray", r.triangles_per_ray},
                {"boxes_per_ray", r.boxes_per_ray},
                {"trace_seconds", r.trace_seconds.median},
                {"trace_seconds_spread", spread_json(r.trace_seconds)},
                {"speedup", r.speedup},
                {"bytes", r.bytes},
                {"depth", r.depth},
                {"sah_cost", r.sah_cost},
                {"end_point_overlap", r.end_point_overlap ? Json(*r.end_point_overlap) : Json()},
                {"hits", r.hits},
                {"short_of_room", r.short_of_room},
                {"tree_hash", fmt::format("{:016x}", r.tree_hash)}});
    if (r.paper) one["paper"] = paper_json(*r.paper);
    all.push_back(std::move(one));
  }
  return all;
}

void write_text(const std::string& path, const std::string& text) {
  if (path == "-") {
    fmt::print("{}", text);
    return;
  }
  OutputFile file(path);
  file.write(text);
  file.commit();
}

std::string machine_line() {
  std::string processor = "unknown processor", line;
  std::ifstream info("/proc/cpuinfo");
  while (std::getline(info, line)) {
    if (line.starts_with("model name")) {
      processor = line.substr(line.find(':') + 2);
      break;
    }
  }
  return fmt::format("{}, {} threads; kerf {}; {:%Y-%m-%d}", processor, std::thread::hardware_concurrency(), kVersion,
                     fmt::gmtime(std::time(nullptr)));
}

}  // namespace kerf::app
