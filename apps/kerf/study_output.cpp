#include "apps/kerf/study_output.h"

#include <fmt/chrono.h>
#include <fmt/core.h>

#include <ctime>
#include <fstream>
#include <thread>

#include "apps/kerf/scene_input.h"
#include "kerf/base/version.h"
#include "kerf/io/output_file.h"

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

}  // namespace

Json study_json(std::span<const StudyResult> results) {
  Json all = Json::array();
  for (const StudyResult& r : results) {
    Json one = {{"scene", r.scene}, {"triangles", r.triangles}, {"row", r.row},
                {"rays", r.rays},   {"ray_count", r.ray_count}, {"finished", r.finished}};
    if (!r.finished) {
      one["why_not"] = r.why_not;
      for (const char* key :
           {"references_per_triangle", "sa_max", "build_seconds", "nodes_per_ray", "triangles_per_ray", "boxes_per_ray",
            "trace_seconds", "speedup", "bytes", "depth", "sah_cost", "end_point_overlap", "hits"}) {
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
