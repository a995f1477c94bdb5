#include "kerf/study/study_pictures.h"

#include <algorithm>

#include "kerf/base/error.h"
#include "kerf/study/figures/canvas.h"
#include "kerf/study/figures/heat_figure.h"
#include "kerf/study/figures/wireframe_figure.h"

namespace kerf {
namespace {

constexpr uint32_t kHeight = 320;  // pixels
constexpr const char* kAnyStructure = "early_split(budget=1.5)+binned_sah";

/// The first row that finished and the one with the greatest speed-up, if that is another.
std::vector<std::string> rows_to_show(std::span<const StudyResult> results) {
  std::vector<const StudyResult*> finished;
  for (const StudyResult& result : results) {
    if (result.finished && result.rays == results.front().rays) finished.push_back(&result);
  }
  if (finished.empty()) return {};
  const StudyResult* fastest = *std::max_element(finished.begin(), finished.end(),
                                                 [](const auto* a, const auto* b) { return a->speedup < b->speedup; });
  std::vector<std::string> rows{finished.front()->row};
  if (fastest != finished.front()) rows.push_back(fastest->row);
  return rows;
}

}  // namespace

std::vector<ReportPicture> study_pictures(const StudyScene& scene, std::span<const StudyResult> results,
                                          const StudyOptions& options) {
  FigureOptions figure;
  figure.height = kHeight;
  figure.width = std::clamp<uint32_t>(kHeight * options.width / options.height, 1, 4 * kHeight);
  figure.threads = options.threads;
  figure.skip_invalid = options.skip_invalid;
  figure.progress = [&](double) { return options.cancelled == nullptr || !*options.cancelled; };
  std::vector<ReportPicture> pictures;
  try {
    pictures.push_back({scene.name, "The model from the camera of the rays, with its edges.",
                        rasterized(wireframe_figure(scene.description, scene.camera, kAnyStructure, "", figure))});
    const std::vector<std::string> rows = rows_to_show(results);
    if (rows.empty()) return pictures;
    const std::string who = rows.size() > 1 ? "in the first row and in the fastest one" : "in the first row";
    pictures.push_back({scene.name,
                        "Nodes (above) and triangle tests (below) of each pixel's primary ray, " + who + ".",
                        rasterized(heat_figure(trace_heat(scene.description, scene.camera, rows, figure)))});
  } catch (const Error& error) {
    if (error.code() != ErrorCode::stopped) throw;
  }
  return pictures;
}

}  // namespace kerf
