#include "kerf/study/report/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "kerf/study/report/number_text.h"

namespace kerf::report {
namespace {

/// The result of a group's row; nullptr for none.
const StudyResult* result_of(const ResultGroup& group, std::string_view row) {
  const auto found = std::find_if(group.results.begin(), group.results.end(),
                                  [&](const StudyResult* result) { return result->row == row; });
  return found == group.results.end() ? nullptr : *found;
}

/// The finished results of a known ray time, fastest first.
std::vector<const StudyResult*> by_speed(const ResultGroup& group) {
  std::vector<const StudyResult*> sorted;
  for (const StudyResult* result : group.results) {
    if (result->finished && result->trace_seconds.median > 0) sorted.push_back(result);
  }
  std::stable_sort(sorted.begin(), sorted.end(), [](const StudyResult* a, const StudyResult* b) {
    return a->trace_seconds.median < b->trace_seconds.median;
  });
  return sorted;
}

void write_row_name(Markup& out, const StudyResult& result, const RowNumbers& numbers) {
  out.element("b", std::to_string(numbers.of(result.row)));
  out.text(" ");
  write_name(out, result.row);
}

void write_fastest(Markup& out, const ResultGroup& group, const RowNumbers& numbers) {
  const std::vector<const StudyResult*> sorted = by_speed(group);
  if (sorted.size() < 2) return;
  const StudyResult& fastest = *sorted[0];
  out.open("p");
  out.text("Shortest ray time: ");
  write_row_name(out, fastest, numbers);
  out.text(fmt::format(", {}", seconds_text(fastest.trace_seconds.median)));
  const StudyResult* first = *std::find_if(group.results.begin(), group.results.end(),
                                           [](const StudyResult* result) { return result->finished; });
  if (first != &fastest && std::isfinite(fastest.speedup)) {
    out.text(fmt::format(", {} times as fast as ", number_text(fastest.speedup)));
    write_row_name(out, *first, numbers);
  }
  out.text(fmt::format(", with {} references per triangle and {}.", number_text(fastest.references_per_triangle),
                       bytes_text(static_cast<double>(fastest.bytes))));
  // Where runs of two rows overlap, their order may be chance.
  std::string close;
  for (size_t i = 1; i < sorted.size() && sorted[i]->trace_seconds.least <= fastest.trace_seconds.most; ++i) {
    if (fastest.trace_seconds.count < 2) break;
    close += fmt::format("{}{}", close.empty() ? "" : ", ", numbers.of(sorted[i]->row));
  }
  if (!close.empty()) out.text(fmt::format(" Its runs overlap those of {}: chance may have ordered them.", close));
  out.close();
  out.line();
}

void write_hits(Markup& out, const ResultGroup& group) {
  size_t finished = 0, least = static_cast<size_t>(-1), most = 0;
  for (const StudyResult* result : group.results) {
    if (!result->finished) continue;
    ++finished;
    least = std::min(least, result->hits);
    most = std::max(most, result->hits);
  }
  if (finished < 2) return;
  if (least == most) {
    out.element(
        "p", fmt::format("All {} rows that finished found the same number of hits, {}.", finished, count_text(least)));
  } else {
    out.element("p", {{"class", "warning"}},
                fmt::format("The rows do not agree on the number of hits: from {} to {}. Find out why before "
                            "comparing them.",
                            count_text(least), count_text(most)));
  }
}

/// How a speed-up is shaded.
std::string_view shade(double speedup) {
  if (!std::isfinite(speedup)) return "none";
  if (speedup >= 3) return "up3";
  if (speedup >= 1.5) return "up2";
  if (speedup >= 1.05) return "up1";
  if (speedup > 0.95) return "same";
  return speedup > 0.6 ? "down1" : "down2";
}

/// The cells of one row; adds to the logarithms.
void write_speedups(Markup& out, std::span<const ResultGroup> groups, std::string_view row) {
  double logarithms = 0;
  bool everywhere = true;
  for (const ResultGroup& group : groups) {
    const StudyResult* result = result_of(group, row);
    if (result == nullptr || !result->finished) {
      out.element("td", {{"class", "none"}, {"data-v", "NaN"}}, result == nullptr ? "\xE2\x80\x93" : "not finished");
      everywhere = false;
      continue;
    }
    out.element("td", {{"class", shade(result->speedup)}, {"data-v", script_number(result->speedup)}},
                number_text(result->speedup) + "\xC3\x97");
    logarithms += std::log(result->speedup);
  }
  const double mean = std::exp(logarithms / static_cast<double>(groups.size()));
  if (everywhere && std::isfinite(mean)) {
    out.element("td", {{"class", "mean"}, {"data-v", script_number(mean)}}, number_text(mean) + "\xC3\x97");
  } else {
    out.element("td", {{"class", "mean none"}, {"data-v", "NaN"}}, "\xE2\x80\x93");
  }
}

}  // namespace

std::vector<ResultGroup> grouped_results(std::span<const StudyResult> results) {
  std::vector<std::string> scenes, kinds;
  const auto add = [](std::vector<std::string>& names, const std::string& name) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  for (const StudyResult& result : results) {
    add(scenes, result.scene);
    add(kinds, result.rays);
  }
  std::vector<ResultGroup> groups;
  for (const std::string& scene : scenes) {
    for (const std::string& rays : kinds) {
      ResultGroup group{scene, rays, {}};
      for (const StudyResult& result : results) {
        if (result.scene == scene && result.rays == rays) group.results.push_back(&result);
      }
      if (!group.results.empty()) groups.push_back(std::move(group));
    }
  }
  return groups;
}

void write_findings(Markup& out, const ResultGroup& group, const RowNumbers& numbers) {
  out.open("div", {{"class", "findings"}});
  write_fastest(out, group, numbers);
  const auto unfinished = std::count_if(group.results.begin(), group.results.end(),
                                        [](const StudyResult* result) { return !result->finished; });
  if (unfinished > 0) {
    out.element("p", fmt::format("{} of {} rows did not finish.", unfinished, group.results.size()));
  }
  write_hits(out, group);
  out.close();
  out.line();
}

void write_overview(Markup& out, std::span<const ResultGroup> groups, const RowNumbers& numbers) {
  if (groups.size() < 2) return;
  constexpr std::string_view kCaption = "Speed-up of ray time over the first row that finished";
  out.open("section", {{"id", "overview"}});
  out.element("h2", "At a glance");
  out.element("p", {{"class", "hint"}}, fmt::format("{}.", kCaption));
  out.open("div", {{"class", "scroll"}, {"tabindex", "0"}, {"role", "region"}, {"aria-label", kCaption}});
  out.open("table", {{"class", "overview"}});
  out.element("caption", kCaption);
  out.open("thead");
  out.open("tr");
  out.open("th", {{"scope", "col"}});
  out.element("span", "Row");
  out.close();
  for (const ResultGroup& group : groups) {
    out.open("th", {{"scope", "col"}});
    out.open("span");
    write_words(out, group.scene);
    out.close();
    out.open("span", {{"class", "words"}});
    write_words(out, group.rays);
    out.close();
    out.close();
  }
  out.open("th", {{"scope", "col"}, {"title", "of rows that finished everywhere"}});
  out.element("span", "Mean");
  out.element("span", {{"class", "words"}}, "geometric");
  out.close();
  out.close();
  out.close();
  out.open("tbody");
  out.line();
  for (size_t i = 0; i < numbers.names().size(); ++i) {
    const std::string& row = numbers.names()[i];
    if (std::none_of(groups.begin(), groups.end(),
                     [&](const ResultGroup& g) { return result_of(g, row) != nullptr; })) {
      continue;
    }
    const std::string number = std::to_string(i + 1);
    out.open("tr", {{"data-row", number}});
    out.open("th", {{"scope", "row"}, {"data-v", number}});
    out.element("b", {{"class", "number"}}, number);
    out.text(" ");
    write_name(out, row);
    out.close();
    write_speedups(out, groups, row);
    out.close();
    out.line();
  }
  out.close();
  out.close();
  out.close();
  out.close();
  out.line();
}

}  // namespace kerf::report
