#include "kerf/study/splitting_report.h"

#include <fmt/format.h>

#include "kerf/study/report/number_text.h"
#include "kerf/study/report/page.h"
#include "kerf/study/report/splitting_figures.h"
#include "kerf/study/report/splitting_sections.h"
#include "kerf/study/splitting_tables.h"

namespace kerf {
using namespace report;

namespace {

constexpr std::string_view kHowMeasured[] = {
    "Visits: nodes whose box a ray enters and triangle tests, weighted alike as in the surface area heuristic; counted "
    "by the scalar kernels, so they repeat exactly. Several kinds of rays together: the geometric mean of their "
    "shares.",
    "Ray speed: the ray time of plain over that of the row, one thread, in runs in which the rows take turns; the "
    "median "
    "of these pairs. Its 95 % interval lies between two of them, by rank (of 15 the 4th and the 12th), and assumes "
    "nothing about how times are distributed.",
    "Build times: medians; timed rows take turns in building too, and their ratios are of pairs.",
    "A goal that could not be measured is not reached."};

std::string scene_id(size_t i) { return fmt::format("scene-{}", i + 1); }

void write_scene(Markup& out, const SplittingScene& scene, const std::string& id) {
  out.open("section", {{"id", id}});
  write_heading(out, "h2", scene.title(), count_text(scene.triangles) + " triangles");
  out.open("div", {{"class", "findings"}});
  for (const std::string& sentence : splitting_sentences(scene)) out.element("p", sentence);
  for (const std::string& skipped : scene.skipped) out.element("p", "Left out: " + skipped);
  out.close();
  write_splitting_charts(out, scene, id);
  out.element("h3", "Goals");
  write_goals(out, scene_verdicts(scene), scene.title() + ": goals");
  out.element("h3", "Rows");
  write_splitting_rows(out, scene);
  out.close();
  out.line();
}

}  // namespace

std::string splitting_report(const SplittingReport& report) {
  std::vector<PageSection> contents{{"goals", "Goals"}, {"overview", "All scenes"}};
  for (size_t i = 0; i < report.scenes.size(); ++i) contents.push_back({scene_id(i), report.scenes[i].title()});
  Markup out;
  begin_page(out, {report.title, report.machine, report.command, {}}, contents);
  out.open("section", {{"id", "goals"}});
  out.element("h2", "Goals");
  write_goals(out, overall_verdicts(report.scenes), "Goals over all scenes");
  out.open("ul", {{"class", "notes"}});
  for (const std::string_view sentence : kHowMeasured) out.element("li", sentence);
  out.close();
  out.close();
  out.open("section", {{"id", "overview"}});
  out.element("h2", "All scenes");
  if (report.scenes.empty()) out.element("p", "This study has no results.");
  write_splitting_overview(out, report.scenes, "overview-dots");
  write_goal_matrix(out, report.scenes);
  out.close();
  for (size_t i = 0; i < report.scenes.size(); ++i) write_scene(out, report.scenes[i], scene_id(i));
  end_page(out);
  return out.take();
}

}  // namespace kerf
