#include "sample_report.h"

#include <cmath>

namespace kerf {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A row of the sample: how its figures are to those of the plain hierarchy.
struct SampleRow {
  const char* name;
  double references, build, nodes, triangles;
};

constexpr SampleRow kRows[] = {
    {"binned_sah", 1, 1, 1, 1},
    {"sweep_sah", 1, 2.4, 0.97, 0.98},
    {"early_split(sa_max=100)+binned_sah(bins=32)", 1.25, 1.3, 0.7, 0.25},
    {"early_split(sa_max=10)+binned_sah(bins=32)", 3.44, 4.2, 0.63, 0.12},
    {"early_split(auto)+binned_sah+reinsertion+bvh8(order=distance)", 1.9, 5.5, 0.41, 0.15},
    {"binned_sah+late_split(sa_max=10,restore_stack=on)", 3.6, 1.9, 1.4, 0.9},
    {"refine(edge=0.1)+sweep_sah", 7.2, 9, 0.9, 0.5},
    {"kd_sah(mailbox=on)", 13.4, 17, 0.5, 0.48},
    {"kd_sah(mailbox=off)", 13.4, 17, 0.5, 0.61},
    {"bih", 1, 0.3, 2.3, 2.2},
    {"octree(leaf=8,depth=12)", 4.4, 0.8, 1.5, 5},
    {"uniform_grid", 5.1, 0.2, 3.2, 3.9},
    {"bsp_sah", 2, 40, 0.6, 0.2},
    {"brute_force", 1, 0.001, 0.03, 9000},
};

struct SampleScene {
  const char* name;
  size_t triangles;
  double nodes, tests;
};

constexpr SampleScene kScenes[] = {
    {"mirror (test data)", 85651, 60.6, 9.73}, {"plant (test data)", 1670000, 193, 58.2}, {"bunny", 69451, 28.6, 1.33}};

/// From -1 to 1, always the same for a number.
double wobble(size_t number) { return std::sin(static_cast<double>(number) * 12.9898 + 4.1414); }

Spread spread_of(double median, size_t number) {
  return {median, median * (0.97 + 0.01 * wobble(number)), median * (1.04 + 0.03 * wobble(number + 7)), 5};
}

StudyResult result_of(const SampleScene& scene, const SampleRow& row, const char* rays, size_t number) {
  StudyResult result;
  result.scene = scene.name;
  result.triangles = scene.triangles;
  result.row = row.name;
  result.rays = rays;
  result.ray_count = 1000000;
  const double change = 1 + 0.06 * wobble(number);
  const auto triangles = static_cast<double>(scene.triangles);
  result.references_per_triangle = row.references;
  result.build_seconds = spread_of(triangles * 9e-7 * row.build * change, number);
  result.nodes_per_ray = scene.nodes * row.nodes * change;
  result.triangles_per_ray = scene.tests * row.triangles / change;
  result.boxes_per_ray = result.nodes_per_ray * 2 - 1;
  const double seconds = (result.nodes_per_ray * 11e-9 + result.triangles_per_ray * 19e-9) * 1e6;
  result.trace_seconds = spread_of(seconds, number + 3);
  result.bytes = static_cast<size_t>(triangles * 60 * row.references * change);
  result.depth = static_cast<uint32_t>(std::log2(triangles) * 1.7 + 4 * wobble(number));
  result.sah_cost = result.nodes_per_ray * 0.7;
  if (number % 5 != 0) result.end_point_overlap = result.triangles_per_ray * 0.11;
  result.hits = rays == std::string("primary") ? 812345 : 498001;
  result.tree_hash = 0x9E3779B97F4A7C15U * (number + 1);
  return result;
}

void leave_unfinished(StudyResult& result, const std::string& why) {
  StudyResult left;
  left.scene = result.scene;
  left.triangles = result.triangles;
  left.row = result.row;
  left.rays = result.rays;
  left.ray_count = result.ray_count;
  left.finished = false;
  left.why_not = why;
  result = left;
}

void add_results(StudyReport& report) {
  size_t number = 0;
  for (const SampleScene& scene : kScenes) {
    for (const char* rays : {"primary", "ambient_occlusion"}) {
      if (rays != std::string("primary") && scene.triangles != 85651) continue;
      const size_t first = report.results.size();
      for (const SampleRow& row : kRows) {
        report.results.push_back(result_of(scene, row, rays, number++));
        StudyResult& result = report.results.back();
        result.speedup = report.results[first].trace_seconds.median / result.trace_seconds.median;
      }
    }
  }
  for (StudyResult& result : report.results) {
    if (result.row.find("auto") != std::string::npos) {
      result.choice =
          SplitChoice{{{1, 44.8}, {1.2, 33.1}, {1.5, 29}, {1.9, 27.2}}, "1 % more would gain \"too\" little"};
    }
    if (result.row == "brute_force" && result.triangles > 80000) {
      leave_unfinished(result, "the limit of 60 seconds was reached after 4 % of the rays");
    } else if (result.row == "bsp_sah" && result.triangles > 1000000) {
      leave_unfinished(result, "the build needs more than 16 GB, which is the limit of memory");
    } else if (result.rays == "primary" && result.triangles == 85651 && result.row == "binned_sah") {
      result.paper = PaperRow{1.00, 0.80, 60.6, 9.73, 4.37, 1.00};
    } else if (result.rays == "primary" && result.triangles == 85651 &&
               result.row.find("sa_max=100)+") != std::string::npos) {
      result.paper = PaperRow{1.25, 1.01, 41.0, 2.32, 2.25, 1.94};
    } else if (result.rays == "primary" && result.triangles == 85651 && result.row == "kd_sah(mailbox=on)") {
      result.paper = PaperRow{13.39, 13.6, 30.9, 4.73, 1.70, 2.57};
    }
  }
}

void add_sweep(StudyReport& report) {
  const SampleScene& scene = kScenes[0];
  double references = 1;
  for (const double limit : {kInfinity, 1000.0, 300.0, 100.0, 30.0, 10.0, 3.0}) {
    const double gain = 1 / (1 + 2.5 * (references - 1));
    const SampleRow row{"", references, references, 0.6 + 0.4 * gain + 0.004 * references, 0.1 + 0.9 * gain};
    StudyResult result = result_of(scene, row, "primary", report.sweep.size());
    result.row = std::isinf(limit) ? "early_split(sa_max=inf)+binned_sah"
                                   : "early_split(sa_max=" + std::to_string(static_cast<int>(limit)) + ")+binned_sah";
    result.sa_max = limit;
    report.sweep.push_back(result);
    report.sweep.back().speedup = report.sweep[0].trace_seconds.median / result.trace_seconds.median;
    references *= 1.42;
  }
}

void add_growth(StudyReport& report) {
  size_t number = 0;
  for (size_t triangles = 1000; triangles <= 10000000; triangles *= 10) {
    const double steps = std::log10(static_cast<double>(triangles));
    for (const SampleRow& row : kRows) {
      const SampleScene scene{"city (test data)", triangles, 9 * steps, 0.8 * steps};
      StudyResult result = result_of(scene, row, "primary", number++);
      if (row.name == std::string("brute_force")) {
        if (triangles > 100000) leave_unfinished(result, "the limit of 60 seconds was reached");
        result.triangles_per_ray = static_cast<double>(triangles);
        result.trace_seconds = spread_of(static_cast<double>(triangles) * 19e-3, number);
      }
      report.growth.push_back(result);
    }
  }
}

/// Something to look at: waves and a disc.
ReportPicture picture(const std::string& scene, const std::string& caption, float turn) {
  constexpr uint32_t kSize = 240;
  ReportPicture made{scene, caption, {kSize, kSize, 3, {}}};
  for (uint32_t y = 0; y < kSize; ++y) {
    for (uint32_t x = 0; x < kSize; ++x) {
      const float u = static_cast<float>(x) / kSize - 0.5F, v = static_cast<float>(y) / kSize - 0.5F;
      const float wave = 0.5F + 0.5F * std::sin(20 * (u * std::cos(turn) + v * std::sin(turn)));
      const bool disc = u * u + v * v < 0.1F;
      for (const float value : {disc ? wave : 0.2F, disc ? 0.6F * wave : 0.3F, disc ? 0.3F : 0.25F + 0.5F * v}) {
        made.image.pixels.push_back(value);
      }
    }
  }
  return made;
}

}  // namespace

StudyResult sample_result(const std::string& scene, const std::string& row) {
  StudyResult result = result_of(kScenes[0], kRows[0], "primary", 1);
  result.scene = scene;
  result.row = row;
  result.speedup = 1;
  return result;
}

StudyReport sample_report() {
  StudyReport report;
  report.title = "Test data: structures side by side";
  report.command =
      "kerf study mirror.ply plant.ply bunny.ply --rows 'binned_sah,early_split(sa_max=10)+binned_sah,kd_sah' "
      "--rays primary,ambient_occlusion --sweep sa_max --html report.html";
  report.machine =
      "Invented processor at 3 GHz, 16 threads for builds, 1 for rays; 1000 x 1000 pixels; 5 runs of each row";
  report.notes = {"All figures of this page are invented: it is what the tests of the report look at.",
                  "The plant stands in for the Power Plant of the paper, which cannot be passed on."};
  add_results(report);
  add_sweep(report);
  add_growth(report);
  report.pictures = {
      picture("mirror (test data)", "Shaded", 0.3F),
      picture("mirror (test data)", "Nodes per ray, binned_sah: 0 to 312", 1.1F),
      picture("mirror (test data)", "Nodes per ray, early_split(sa_max=10)+binned_sah(bins=32): 0 to 312", 2.0F),
      picture("plant (test data)", "Shaded", 2.7F)};
  return report;
}

}  // namespace kerf
