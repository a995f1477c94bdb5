#include "kerf/study/html_report.h"

#include <fmt/format.h>

#include <algorithm>

#include "kerf/io/image_write.h"
#include "kerf/study/report/figures.h"
#include "kerf/study/report/markup.h"
#include "kerf/study/report/number_text.h"
#include "kerf/study/report/page.h"
#include "kerf/study/report/results_table.h"
#include "kerf/study/report/row_style.h"
#include "kerf/study/report/splitting_figures.h"
#include "kerf/study/report/summary.h"

namespace kerf {
using namespace report;

namespace {

constexpr std::string_view kNoTitle = "Study of ray tracing structures";

std::string or_else(const std::string& text, std::string_view otherwise) {
  return text.empty() ? std::string(otherwise) : text;
}

/// The scenes of results and pictures, in the order in which they first come.
std::vector<std::string> scene_names(const StudyReport& report) {
  std::vector<std::string> names;
  const auto add = [&](const std::string& name) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  for (const StudyResult& result : report.results) add(result.scene);
  for (const ReportPicture& picture : report.pictures) add(picture.scene);
  return names;
}

std::string shown_scene(const std::string& scene) { return or_else(scene, "Scene without a name"); }

std::vector<PageSection> sections(const StudyReport& report, const std::vector<std::string>& scenes, bool overview) {
  std::vector<PageSection> found;
  if (overview) found.push_back({"overview", "At a glance"});
  for (size_t i = 0; i < scenes.size(); ++i) found.push_back({fmt::format("scene-{}", i + 1), shown_scene(scenes[i])});
  if (!report.sweep.empty()) found.push_back({"sweep", "How much to split"});
  if (!report.growth.empty()) found.push_back({"growth", "The cost of growth"});
  found.push_back({"legend", "What the columns mean"});
  return found;
}

void write_pictures(Markup& out, const StudyReport& report, const std::string& scene) {
  const auto is_here = [&](const ReportPicture& picture) { return picture.scene == scene; };
  if (std::none_of(report.pictures.begin(), report.pictures.end(), is_here)) return;
  out.open("div", {{"class", "pictures"}});
  for (const ReportPicture& picture : report.pictures) {
    if (!is_here(picture)) continue;
    const std::vector<unsigned char> png = encode_png(picture.image, "picture '" + picture.caption + "'");
    out.open("figure");
    out.leaf("img", {{"src", "data:image/png;base64," + base64(png)},
                     {"width", std::to_string(picture.image.width)},
                     {"height", std::to_string(picture.image.height)},
                     {"alt", shown_scene(scene) + ": " + or_else(picture.caption, "picture")}});
    if (!picture.caption.empty()) out.element("figcaption", picture.caption);
    out.close();
  }
  out.close();
  out.line();
}

std::string rays_text(const ResultGroup& group) { return fmt::format("{} rays", or_else(group.rays, "unnamed")); }

void write_group(Markup& out, const ResultGroup& group, const RowNumbers& numbers, const std::string& id) {
  write_heading(out, "h3", rays_text(group), count_text(group.results[0]->ray_count) + " rays");
  write_findings(out, group, numbers);
  write_table(out, group.results, numbers, TableRows::pipelines,
              fmt::format("{}, {}", shown_scene(group.scene), rays_text(group)));
  write_scene_charts(out, group.results, numbers, id);
}

/// How far automatic splitting went in this scene, and why; a row has one choice for all kinds of rays.
void write_choices(Markup& out, const StudyReport& report, const std::string& scene, const RowNumbers& numbers,
                   const std::string& id) {
  std::vector<const StudyResult*> chosen;
  for (const StudyResult& result : report.results) {
    const bool is_known =
        std::any_of(chosen.begin(), chosen.end(), [&](const auto* r) { return r->row == result.row; });
    if (result.scene == scene && result.finished && result.choice && !is_known) chosen.push_back(&result);
  }
  if (chosen.empty()) return;
  out.element("h3", "How far automatic splitting went");
  for (const StudyResult* result : chosen) {
    out.open("p");
    write_name(out, result->row);
    out.text(": " + result->choice->reason + ".");
    out.close();
  }
  out.open("div", {{"class", "charts"}});
  for (const StudyResult* result : chosen) {
    write_choice_chart(out, *result->choice, fmt::format("{}-choice-{}", id, numbers.of(result->row)));
  }
  out.close();
  out.line();
}

void write_scene(Markup& out, const StudyReport& report, const std::string& scene,
                 const std::vector<ResultGroup>& groups, const RowNumbers& numbers, const std::string& id) {
  out.open("section", {{"id", id}});
  const auto first = std::find_if(report.results.begin(), report.results.end(),
                                  [&](const StudyResult& result) { return result.scene == scene; });
  write_heading(out, "h2", shown_scene(scene),
                first == report.results.end() ? "" : count_text(first->triangles) + " triangles");
  write_pictures(out, report, scene);
  size_t count = 0;
  for (const ResultGroup& group : groups) {
    if (group.scene == scene) write_group(out, group, numbers, fmt::format("{}-{}", id, ++count));
  }
  write_choices(out, report, scene, numbers, id);
  out.close();
  out.line();
}

/// A row whose sa_max is left open: what the rows of a sweep have in common.
std::string without_limit(const std::string& row) {
  constexpr std::string_view kOption = "sa_max=";
  const size_t at = row.find(kOption);
  if (at == std::string::npos) return row;
  const size_t begin = at + kOption.size(), end = std::min(row.find_first_of(",)", begin), row.size());
  return row.substr(0, begin) + "\xE2\x80\xA6" + row.substr(end);
}

void write_sweep(Markup& out, const StudyReport& report) {
  if (report.sweep.empty()) return;
  out.open("section", {{"id", "sweep"}});
  out.element("h2", "How much to split");
  out.element("p",
              "One pipeline with different limits of early split clipping, from none on: what more references buy.");
  size_t count = 0;
  for (ResultGroup& group : grouped_results(report.sweep)) {
    while (!group.results.empty()) {
      const std::string row = without_limit(group.results[0]->row);
      const auto others = std::stable_partition(group.results.begin(), group.results.end(),
                                                [&](const StudyResult* r) { return without_limit(r->row) == row; });
      const std::vector<const StudyResult*> curve(group.results.begin(), others);
      group.results.erase(group.results.begin(), others);
      write_heading(out, "h3", fmt::format("{}, {}", shown_scene(group.scene), rays_text(group)), "");
      out.open("p");
      write_name(out, row);
      out.close();
      write_sweep_charts(out, curve, fmt::format("sweep-{}", ++count));
      write_table(out, curve, {}, TableRows::limits, "The figures of these curves");
    }
  }
  out.close();
  out.line();
}

void write_growth(Markup& out, const StudyReport& report, const RowNumbers& numbers) {
  if (report.growth.empty()) return;
  out.open("section", {{"id", "growth"}});
  out.element("h2", "The cost of growth");
  out.element("p",
              "Scenes of one family, from few triangles to many. On logarithmic scales a straight line is a power: "
              "doubling the triangles multiplies the cost by the same factor everywhere.");
  std::vector<std::string> kinds;
  for (const StudyResult& result : report.growth) {
    if (std::find(kinds.begin(), kinds.end(), result.rays) == kinds.end()) kinds.push_back(result.rays);
  }
  for (size_t i = 0; i < kinds.size(); ++i) {
    ResultGroup group{"", kinds[i], {}};
    for (const StudyResult& result : report.growth) {
      if (result.rays == kinds[i]) group.results.push_back(&result);
    }
    write_heading(out, "h3", rays_text(group), "");
    write_growth_charts(out, group.results, numbers, fmt::format("growth-{}", i + 1));
    out.open("details");
    out.element("summary", fmt::format("The {} results behind these curves", group.results.size()));
    write_table(out, group.results, numbers, TableRows::scenes, "Growth, " + rays_text(group));
    out.close();
    out.line();
  }
  out.close();
  out.line();
}

}  // namespace

std::string html_report(const StudyReport& report) {
  RowNumbers numbers;
  for (const StudyResult& result : report.results) numbers.add(result.row);
  for (const StudyResult& result : report.growth) numbers.add(result.row);
  const std::vector<ResultGroup> groups = grouped_results(report.results);
  const std::vector<std::string> scenes = scene_names(report);
  Markup out;
  begin_page(out, {or_else(report.title, kNoTitle), report.machine, report.command, report.notes},
             sections(report, scenes, groups.size() > 1));
  if (report.results.empty() && report.sweep.empty() && report.growth.empty()) {
    out.element("p", "This study has no results.");
  }
  write_overview(out, groups, numbers);
  for (size_t i = 0; i < scenes.size(); ++i) {
    write_scene(out, report, scenes[i], groups, numbers, fmt::format("scene-{}", i + 1));
  }
  write_sweep(out, report);
  write_growth(out, report, numbers);
  write_legend(out);
  end_page(out);
  return out.take();
}

}  // namespace kerf
