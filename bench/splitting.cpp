// kerf_bench_splitting: what early splitting does to nodes and triangles per ray and to ray time, on real scenes,
// straight and turned. Counts repeat exactly. Times are of one thread; the structures take turns, and each pair of runs
// that follow each other gives one ratio, of which the median and the spread are printed.

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

#include "kerf/base/error.h"
#include "kerf/io/ply.h"
#include "kerf/scene/scene.h"
#include "tests/support/scenes.h"

namespace kerf::test {
namespace {

struct Arguments {
  std::vector<std::string> scenes{"sponza", "staircase", "housing_coarse"}, turns{"straight", "xyz"};
  std::vector<double> budgets{1.2, 1.5, 2};
  std::string builder = "binned_sah", json;
  uint32_t width = 480, height = 320;
  int repeats = 15;
};

struct Row {
  std::string structure;
  Scene scene;
  TraceCounts counts;
  std::vector<double> seconds;
};

double trace_seconds(const Scene& scene, const std::vector<Ray>& rays, std::vector<Hit>& hits) {
  const auto start = std::chrono::steady_clock::now();
  scene.closest_hit(rays, hits, 1);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
}

std::vector<Row> build_rows(const Mesh& mesh, const Arguments& arguments) {
  std::vector<Row> rows;
  rows.push_back({arguments.builder, {}, {}, {}});
  for (const double budget : arguments.budgets) {
    rows.push_back({fmt::format("early_split(budget={})+{}", budget, arguments.builder), {}, {}, {}});
  }
  for (Row& row : rows) {
    row.scene.add(TriangleMesh{std::span(mesh.vertices), std::span(mesh.triangles)});
    row.scene.build({.structure = row.structure});
  }
  return rows;
}

/// Traces the rays with every row in turn, again and again; checks that all find the same hits.
void trace_rows(std::vector<Row>& rows, const std::vector<Ray>& rays, int repeats) {
  std::vector<Hit> first(rays.size()), hits(rays.size());
  rows[0].scene.closest_hit(rays, first);
  for (Row& row : rows) {
    for (const Ray& ray : rays) row.scene.closest_hit(ray, row.counts);
    row.scene.closest_hit(rays, hits);
    if (hits != first) throw Error(ErrorCode::invalid_argument, row.structure, "finds other hits than the first row");
  }
  for (int i = 0; i < repeats; ++i) {
    for (Row& row : rows) row.seconds.push_back(trace_seconds(row.scene, rays, hits));
  }
}

nlohmann::ordered_json print_row(const std::string& scene, const std::string& turn, const Row& row, const Row& plain,
                                 size_t rays) {
  std::vector<double> speedups;
  for (size_t i = 0; i < row.seconds.size(); ++i) speedups.push_back(plain.seconds[i] / row.seconds[i]);
  const auto n = static_cast<double>(rays);
  const BuildReport& report = row.scene.report();
  const double nodes = static_cast<double>(row.counts.nodes) / n,
               primitives = static_cast<double>(row.counts.primitives) / n;
  const double nanoseconds = quantile(row.seconds, 0.5) / n * 1e9;
  fmt::print("{:<15} {:<9} {:<36} {:>6.3f} {:>8.2f} {:>8.2f} {:>8.0f} {:>7.2f}x  ({:.2f} to {:.2f})\n", scene, turn,
             row.structure, report.references_per_primitive, nodes, primitives, nanoseconds, quantile(speedups, 0.5),
             quantile(speedups, 0.1), quantile(speedups, 0.9));
  std::fflush(stdout);
  return {{"scene", scene},
          {"turn", turn},
          {"structure", row.structure},
          {"references_per_triangle", report.references_per_primitive},
          {"nodes_per_ray", nodes},
          {"triangles_per_ray", primitives},
          {"nanoseconds_per_ray", nanoseconds},
          {"speedup", quantile(speedups, 0.5)},
          {"sah_cost", report.sah_cost},
          {"bytes", report.bytes}};
}

int run(const Arguments& arguments) {
  const std::optional<std::string> folder = scenes_folder();
  if (!folder) throw Error(ErrorCode::file, "KERF_SCENES", "it must name the folder of scenes");
  fmt::print("{:<15} {:<9} {:<36} {:>6} {:>8} {:>8} {:>8} {:>8}  {}\n", "scene", "turn", "structure", "R", "nodes",
             "tris", "ns/ray", "speedup", "(10 % to 90 %)");
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const SceneCamera& entry : read_cameras(*folder)) {
    const auto& wanted = arguments.scenes;
    if (entry.name != "1" || std::find(wanted.begin(), wanted.end(), entry.scene) == wanted.end()) continue;
    for (const std::string& turn_name : arguments.turns) {
      const Transform turn = turn_by_name(turn_name);
      const Mesh mesh = turned(read_ply(*folder + "/" + entry.scene + ".ply"), turn);
      const std::vector<Ray> rays = camera_rays(turned(entry.camera, turn), arguments.width, arguments.height);
      std::vector<Row> rows = build_rows(mesh, arguments);
      trace_rows(rows, rays, arguments.repeats);
      for (const Row& row : rows) json.push_back(print_row(entry.scene, turn_name, row, rows[0], rays.size()));
    }
  }
  if (!arguments.json.empty()) std::ofstream(arguments.json) << json.dump(2) << "\n";
  return 0;
}

}  // namespace
}  // namespace kerf::test

int main(int argc, char** argv) {
  kerf::test::Arguments arguments;
  CLI::App app("Measures what early splitting does to the primary rays of camera 1 of the scenes of KERF_SCENES.");
  app.footer("Example: kerf_bench_splitting --scenes sponza --budgets 1.2,1.5,2 --repeats 15");
  app.add_option("--scenes", arguments.scenes, "Scenes to take")->delimiter(',')->capture_default_str();
  app.add_option("--turns", arguments.turns, "straight, x, y, z, xyz")->delimiter(',')->capture_default_str();
  app.add_option("--budgets", arguments.budgets, "References per triangle")->delimiter(',')->capture_default_str();
  app.add_option("--builder", arguments.builder, "The builder")->capture_default_str();
  app.add_option("--width", arguments.width, "Rays in a row")->capture_default_str();
  app.add_option("--height", arguments.height, "Rows of rays")->capture_default_str();
  app.add_option("--repeats", arguments.repeats, "Rounds of alternating runs")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--json", arguments.json, "Write the table to this file");
  CLI11_PARSE(app, argc, argv);
  try {
    return kerf::test::run(arguments);
  } catch (const kerf::Error& error) {
    fmt::print(stderr, "kerf_bench_splitting: {}\n", error.what());
    return 1;
  }
}
