// kerf_agreement: every structure against brute force and Embree's robust scene on real scenes, straight and turned.
// Prints a table of differing pixels by kind; fails if one is unexplained, if brute force differs at all, or if the
// depth is off.

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <vector>

#include "kerf/base/error.h"
#include "kerf/base/parallel.h"
#include "kerf/io/ply.h"
#include "kerf/scene/pipeline.h"
#include "kerf/scene/scene.h"
#include "kerf/study/embree_builder.h"
#include "kerf/study/hit_verdict.h"
#include "tests/support/embree_scene.h"
#include "tests/support/scenes.h"
#include "tests/support/structures.h"

namespace kerf::test {
namespace {

constexpr int kSkipped = 77;

struct Arguments {
  std::vector<std::string> scenes, turns{"straight", "xyz"};
  std::string structures, size = "120x80", json;
  size_t brute_rays = 10000;
  double limit_seconds = std::numeric_limits<double>::infinity();
  bool once = false, verbose = false;
};

/// The sums of one row of the table.
struct Tally {
  size_t rays = 0, hits = 0;
  std::array<size_t, kVerdicts> verdicts{};
  size_t deep = 0;              ///< both hit, depths differ by more than 1e-5
  double depth_difference = 0;  ///< the largest where the oracle is not wrong
  size_t brute_rays = 0, brute_different = 0;

  void add(const Tally& other) {
    rays += other.rays;
    hits += other.hits;
    for (int i = 0; i < kVerdicts; ++i) verdicts[i] += other.verdicts[i];
    deep += other.deep;
    depth_difference = std::max(depth_difference, other.depth_difference);
    brute_rays += other.brute_rays;
    brute_different += other.brute_different;
  }
  size_t of(Verdict verdict) const { return verdicts[static_cast<size_t>(verdict)]; }
  /// A depth may differ by more than 1e-5 only where the oracle is wrong or the two sides of an edge are at issue.
  bool is_good() const {
    return of(Verdict::unexplained) == 0 && brute_different == 0 && depth_difference <= 1e-5 &&
           deep <= of(Verdict::oracle_wrong) + of(Verdict::edge_tie);
  }
};

/// What the oracles say about the rays of all cameras of a scene.
struct Expected {
  std::vector<Ray> rays;
  std::vector<Hit> embree;
  std::vector<size_t> brute_numbers;  ///< the rays that were traced by brute force too, spread evenly
  std::vector<Hit> brute;
};

Expected ask_oracles(const Mesh& mesh, const std::vector<SceneCamera>& cameras, const Transform& turn,
                     const Arguments& arguments, uint32_t width, uint32_t height) {
  Expected expected;
  for (const SceneCamera& entry : cameras) {
    const std::vector<Ray> rays = camera_rays(turned(entry.camera, turn), width, height);
    expected.rays.insert(expected.rays.end(), rays.begin(), rays.end());
  }
  const EmbreeScene embree(mesh);
  expected.embree.resize(expected.rays.size());
  parallel_for(expected.rays.size(), 1024, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) expected.embree[i] = embree.closest_hit(expected.rays[i]);
  });
  const size_t wanted = std::min(arguments.brute_rays * cameras.size(), expected.rays.size());
  std::vector<Ray> sample;
  for (size_t i = 0; i < wanted; ++i) {
    expected.brute_numbers.push_back(i * expected.rays.size() / wanted);
    sample.push_back(expected.rays[expected.brute_numbers.back()]);
  }
  expected.brute.resize(wanted);
  Scene brute;
  brute.add(TriangleMesh{std::span(mesh.vertices), std::span(mesh.triangles)});
  brute.build({.structure = "brute_force"});
  brute.closest_hit(sample, expected.brute);
  return expected;
}

/// Throws Error (stopped) if the build takes longer than the limit.
Tally compare(const Mesh& mesh, const Expected& expected, const std::string& structure, const Arguments& arguments) {
  Scene scene;
  scene.add(TriangleMesh{std::span(mesh.vertices), std::span(mesh.triangles)});
  scene.build({.structure = structure, .limit = WorkLimit::seconds(arguments.limit_seconds)});
  std::vector<Hit> hits(expected.rays.size());
  scene.closest_hit(expected.rays, hits);
  Tally tally;
  tally.rays = hits.size();
  for (size_t i = 0; i < hits.size(); ++i) {
    double difference = 0;
    const Verdict verdict = judge(mesh, expected.rays[i], hits[i], expected.embree[i], difference);
    ++tally.verdicts[static_cast<size_t>(verdict)];
    tally.hits += hits[i] ? 1 : 0;
    const bool same_place = verdict == Verdict::same || verdict == Verdict::coincident;
    if (same_place) tally.depth_difference = std::max(tally.depth_difference, difference);
    if (difference > 1e-5) ++tally.deep;
    if (arguments.verbose && verdict != Verdict::same) {
      fmt::print("  ray {}: {}: kerf {} at {:.9g}, oracle {} at {:.9g}\n", i, verdict_name(verdict),
                 static_cast<int64_t>(static_cast<int32_t>(hits[i].primitive)), hits[i].t,
                 static_cast<int64_t>(static_cast<int32_t>(expected.embree[i].primitive)), expected.embree[i].t);
    }
  }
  tally.brute_rays = expected.brute.size();
  for (size_t i = 0; i < expected.brute.size(); ++i) {
    tally.brute_different += expected.brute[i] != hits[expected.brute_numbers[i]] ? 1 : 0;
  }
  return tally;
}

void print_row(const std::string& scene, const std::string& turn, const std::string& structure, const Tally& t) {
  fmt::print("{:<15} {:<8} {:<40} {:>8} {:>8} {:>6} {:>6} {:>6} {:>6} {:>6} {:>9.2g} {:>7} {:>6}{}\n", scene, turn,
             structure, t.rays, t.hits, t.of(Verdict::edge_tie), t.of(Verdict::coincident), t.of(Verdict::oracle_wrong),
             t.of(Verdict::unexplained), t.deep, t.depth_difference, t.brute_rays, t.brute_different,
             t.is_good() ? "" : "  FAILED");
  std::fflush(stdout);
}

nlohmann::ordered_json row_json(const std::string& scene, const std::string& turn, const std::string& structure,
                                const Tally& t) {
  return {{"scene", scene},
          {"turn", turn},
          {"structure", structure},
          {"rays", t.rays},
          {"hits", t.hits},
          {"edge_tie", t.of(Verdict::edge_tie)},
          {"coincident", t.of(Verdict::coincident)},
          {"oracle_wrong", t.of(Verdict::oracle_wrong)},
          {"unexplained", t.of(Verdict::unexplained)},
          {"depth_difference", t.depth_difference},
          {"depth_differs", t.deep},
          {"brute_force_rays", t.brute_rays},
          {"brute_force_differs", t.brute_different}};
}

int run(const Arguments& arguments) {
  const std::optional<std::string> folder = scenes_folder();
  if (!folder) {
    fmt::print("skipped: KERF_SCENES is not set\n");
    return kSkipped;
  }
  uint32_t width = 0, height = 0;
  if (std::sscanf(arguments.size.c_str(), "%ux%u", &width, &height) != 2) {
    throw Error(ErrorCode::invalid_option, "--size", "expected WIDTHxHEIGHT");
  }
  std::map<std::string, std::vector<SceneCamera>> cameras;
  for (const SceneCamera& entry : read_cameras(*folder)) {
    const auto& wanted = arguments.scenes;
    if (wanted.empty() || std::find(wanted.begin(), wanted.end(), entry.scene) != wanted.end()) {
      cameras[entry.scene].push_back(entry);
    }
  }
  if (cameras.empty()) {
    fmt::print("skipped: no such scene in the folder\n");
    return kSkipped;
  }
  const std::vector<std::string> structures = !arguments.structures.empty() ? split_pipeline_list(arguments.structures)
                                              : arguments.once              ? menu_pipelines()
                                                                            : all_pipelines();
  fmt::print("{:<15} {:<8} {:<40} {:>8} {:>8} {:>6} {:>6} {:>6} {:>6} {:>6} {:>9} {:>7} {:>6}\n", "scene", "turn",
             "structure", "rays", "hits", "edge", "coinc", "oracle", "unexpl", "depth", "max depth", "brute", "differ");
  Tally total;
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const auto& [scene, entries] : cameras) {
    const Mesh straight = read_ply(*folder + "/" + scene + ".ply");
    for (const std::string& turn_name : arguments.turns) {
      const Transform turn = turn_by_name(turn_name);
      const Mesh mesh = turned(straight, turn);
      const Expected expected = ask_oracles(mesh, entries, turn, arguments, width, height);
      for (const std::string& structure : structures) {
        try {
          const Tally tally = compare(mesh, expected, structure, arguments);
          print_row(scene, turn_name, structure, tally);
          rows.push_back(row_json(scene, turn_name, structure, tally));
          total.add(tally);
        } catch (const Error& error) {
          if (error.code() != ErrorCode::stopped) throw;
          fmt::print("{:<15} {:<8} {:<40} not compared: {}\n", scene, turn_name, structure, error.what());
        }
      }
    }
  }
  print_row("all", "", "", total);
  if (!arguments.json.empty()) std::ofstream(arguments.json) << rows.dump(2) << "\n";
  return total.is_good() ? 0 : 1;
}

}  // namespace
}  // namespace kerf::test

int main(int argc, char** argv) {
  kerf::add_embree_builders();
  kerf::test::Arguments arguments;
  CLI::App app("Compares every structure with brute force and Embree's robust scene on the scenes of KERF_SCENES.");
  app.footer("Example: kerf_agreement --scenes sponza,bunny --turns straight,x,y,z,xyz --size 300x200");
  app.add_option("--scenes", arguments.scenes, "Scenes to take (default: all)")->delimiter(',');
  app.add_option("--turns", arguments.turns, "straight, x, y, z, xyz")->delimiter(',')->capture_default_str();
  app.add_option("--structures", arguments.structures,
                 "Pipelines (default: everything in the menu, every word of its options, plain and split at R = 2)");
  app.add_flag("--once", arguments.once, "Everything in the menu once");
  app.add_option("--limit-seconds", arguments.limit_seconds, "Leave out what takes longer to build");
  app.add_option("--size", arguments.size, "Rays of each camera")->capture_default_str();
  app.add_option("--brute-rays", arguments.brute_rays, "Rays of each camera traced by brute force too")
      ->capture_default_str();
  app.add_option("--json", arguments.json, "Write the table to this file");
  app.add_flag("--verbose", arguments.verbose, "Print every ray that differs");
  CLI11_PARSE(app, argc, argv);
  try {
    return kerf::test::run(arguments);
  } catch (const kerf::Error& error) {
    fmt::print(stderr, "kerf_agreement: {}\n", error.what());
    return 1;
  }
}
