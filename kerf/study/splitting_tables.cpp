#include "kerf/study/splitting_tables.h"

#include <fmt/format.h>

#include <cmath>

#include "kerf/study/splitting_goals.h"
#include "kerf/study/spread.h"
#include "kerf/study/tables.h"

namespace kerf {
namespace {

using Role = SplittingRole;

constexpr size_t kNameWidth = 13, kKindWidth = 21, kGoalWidth = 22, kStateWidth = 12;

/// "1.35x (1.31 to 1.38)"; nothing for rows whose rays are not timed.
std::string speed_text(const std::vector<double>& speeds) {
  if (speeds.empty()) return "";
  std::string text = fmt::format("{:.2f}x", median_of(speeds));
  if (const auto interval = median_interval(speeds)) {
    text += fmt::format(" ({:.2f} to {:.2f})", interval->lower, interval->upper);
  }
  return text;
}

double median_seconds(const SplittingRow& row, double BuildReport::Seconds::*part) {
  std::vector<double> seconds;
  for (const BuildReport::Seconds& build : row.builds) seconds.push_back(build.*part);
  return median_of(std::move(seconds));
}

std::string heading(const SplittingScene& scene) {
  std::string rays;
  for (size_t k = 0; k < scene.kinds.size(); ++k) {
    rays += fmt::format("{}{} {}", k > 0 ? ", " : "", scene.ray_counts[k], scene.kinds[k]);
  }
  std::string text = fmt::format("{}: {} triangles; rays: {}\n{:<{}} {:>6} {:>8} {:>8} {:>8} {:>8}", scene.title(),
                                 scene.triangles, rays, "", kNameWidth, "R", "T_split", "T_build", "bytes", "SAH");
  for (const std::string& kind : scene.kinds) text += fmt::format("  {:>{}}", kind, kKindWidth);
  return text + "  ray speed, all kinds\n";
}

std::string row_line(const SplittingScene& scene, const SplittingRow& row) {
  if (!row.finished) return fmt::format("{:<{}} not finished: {}\n", row_name(row), kNameWidth, row.why_not);
  std::string text =
      fmt::format("{:<{}} {:>6.3f} {:>8.4f} {:>8.4f} {:>8} {:>8.2f}", row_name(row), kNameWidth,
                  row.references_per_primitive, median_seconds(row, &BuildReport::Seconds::split),
                  median_seconds(row, &BuildReport::Seconds::total), bytes_text(row.bytes), row.sah_cost);
  for (size_t k = 0; k < row.rays.size(); ++k) {
    const SplittingRow::Rays& rays = row.rays[k];
    text += "  " + fmt::format(
                       "{:>{}}",
                       fmt::format("{:.1f} + {:.1f} = {:.3f}", rays.nodes, rays.triangles, visits_share(scene, row, k)),
                       kKindWidth);
  }
  const SplittingRow* plain = scene.row(Role::plain);
  const std::string speed = plain != nullptr && plain != &row ? speed_text(paired_speeds(scene, *plain, row)) : "";
  return text + (speed.empty() ? "" : "  " + speed) + "\n" + room_line(row.short_of_room);
}

std::string goal_lines(const std::vector<GoalVerdict>& verdicts) {
  std::string text;
  for (const GoalVerdict& verdict : verdicts) {
    text += fmt::format("  {:<{}} {:<{}} {}\n", verdict.goal->name, kGoalWidth, state_name(verdict.state), kStateWidth,
                        verdict.text);
  }
  return text;
}

std::string csv_times(const std::vector<double>& speeds) {
  if (speeds.empty()) return ",,,";
  const auto interval = median_interval(speeds);
  return fmt::format("{},{},{},{}", speeds.size(), median_of(speeds),
                     interval ? fmt::format("{}", interval->lower) : "",
                     interval ? fmt::format("{}", interval->upper) : "");
}

std::string csv_line(const SplittingScene& scene, const SplittingRow& row, size_t k) {
  std::string text = fmt::format("{},{},{},{},{},{},{},{},{}", csv_field(scene.name), scene.turn, scene.triangles,
                                 csv_field(row_name(row)), csv_field(row.pipeline), scene.kinds[k], scene.ray_counts[k],
                                 row.finished, row.finished ? "" : csv_field(row.why_not));
  if (!row.finished) return text + std::string(15, ',') + "\n";
  const SplittingRow::Rays& rays = row.rays[k];
  text +=
      fmt::format(",{},{},{},{},{},{}", row.references_per_primitive, median_seconds(row, &BuildReport::Seconds::split),
                  median_seconds(row, &BuildReport::Seconds::total), row.bytes,
                  row.peak_bytes ? fmt::format("{}", *row.peak_bytes) : "", row.sah_cost);
  text +=
      fmt::format(",{},{},{},{},{}", rays.nodes, rays.triangles, rays.visits(), visits_share(scene, row, k), rays.hits);
  const SplittingRow* plain = scene.row(Role::plain);
  return text + "," + csv_times(plain != nullptr ? paired_speeds(*plain, row, k) : std::vector<double>()) + "\n";
}

}  // namespace

std::string row_name(const SplittingRow& row) {
  return row.role == Role::budget ? fmt::format("budget {}", row.budget) : std::string(splitting_row(row.role).name);
}

std::vector<std::string> splitting_sentences(const SplittingScene& scene) {
  const SplittingRow *plain = scene.row(Role::plain), *automatic = scene.row(Role::automatic);
  if (plain == nullptr || automatic == nullptr) return {};
  const double cost = splitting_cost(*plain, *automatic);
  std::vector<std::string> sentences{fmt::format(
      "early_split(auto): {:.3f} references per primitive, {} instead of {}; cutting and choosing took {:.4f} s, "
      "{:.0f} % of the plain build.",
      automatic->references_per_primitive, bytes_text(automatic->bytes), bytes_text(plain->bytes),
      median_seconds(*automatic, &BuildReport::Seconds::split), 100 * cost)};
  std::string rays;
  for (size_t k = 0; k < scene.kinds.size(); ++k) {
    const double share = visits_share(scene, *automatic, k);
    if (std::isnan(share)) continue;
    const std::string speed = speed_text(paired_speeds(*plain, *automatic, k));
    rays += fmt::format("{}{} {:.3f} of the visits{}", rays.empty() ? "" : "; ", scene.kinds[k], share,
                        speed.empty() ? "" : ", " + speed + " as fast");
  }
  if (!rays.empty()) sentences.push_back("Rays: " + rays + ".");
  if (automatic->choice) sentences.push_back("Why: " + automatic->choice->reason + ".");
  return sentences;
}

std::string splitting_text(std::span<const SplittingScene> scenes) {
  std::string text;
  for (const SplittingScene& scene : scenes) {
    text += heading(scene);
    for (const SplittingRow& row : scene.rows) text += row_line(scene, row);
    for (const std::string& skipped : scene.skipped) text += "left out: " + skipped + "\n";
    for (const std::string& sentence : splitting_sentences(scene)) text += sentence + "\n";
    text += "goals:\n" + goal_lines(scene_verdicts(scene)) + "\n";
  }
  if (scenes.empty()) return text;
  return text + fmt::format("goals over all {} scenes:\n", scenes.size()) + goal_lines(overall_verdicts(scenes));
}

std::string splitting_csv(std::span<const SplittingScene> scenes) {
  std::string text =
      "scene,turn,triangles,row,pipeline,rays,ray_count,finished,why_not,references_per_primitive,split_seconds,"
      "build_seconds,bytes,peak_bytes,sah_cost,nodes_per_ray,triangles_per_ray,visits_per_ray,visits_of_plain,hits,"
      "timed_runs,speed,speed_lower,speed_upper\n";
  for (const SplittingScene& scene : scenes) {
    for (const SplittingRow& row : scene.rows) {
      for (size_t k = 0; k < scene.kinds.size(); ++k) text += csv_line(scene, row, k);
    }
  }
  return text;
}

}  // namespace kerf
