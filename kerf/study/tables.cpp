#include "kerf/study/tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {
namespace {

constexpr size_t kWidestRow = 60;

/// Three digits that count.
std::string short_number(double x) {
  if (!std::isfinite(x)) return fmt::format("{}", x);
  const double size = std::abs(x);
  if (size >= 1e5) return fmt::format("{:.2e}", x);
  return fmt::format("{:.{}f}", x, size >= 100 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : 3);
}

/// A row's name in lines that fit, broken where a stage begins.
std::vector<std::string> folded(const std::string& row) {
  std::vector<std::string> lines{""};
  size_t begin = 0;
  while (begin < row.size()) {
    size_t end = begin;
    for (int open = 0; end < row.size() && (open > 0 || row[end] != '+' || end == begin); ++end) {
      open += row[end] == '(' ? 1 : row[end] == ')' ? -1 : 0;
    }
    const std::string stage = row.substr(begin, end - begin);
    if (!lines.back().empty() && lines.back().size() + stage.size() > kWidestRow) lines.emplace_back("  ");
    lines.back() += stage;
    begin = end;
  }
  return lines;
}

size_t width_of(std::span<const StudyResult> results) {
  size_t width = 10;
  for (const StudyResult& result : results) {
    for (const std::string& line : folded(result.row)) width = std::max(width, line.size());
  }
  return width;
}

std::string heading(const StudyResult& first, size_t width) {
  return fmt::format(
      "{}: {} triangles, {} {} rays\n{:<{}} {:>6} {:>8} {:>7} {:>7} {:>8} {:>7}  {:>7} {:>8} {:>5} {:>8} {:>7} {:>9}\n",
      first.scene, first.triangles, first.ray_count, first.rays, "", width, "R", "T_build", "N_node", "N_tri", "T_ray",
      "S", "boxes", "bytes", "depth", "SAH", "overlap", "hits");
}

std::string figures(const StudyResult& r) {
  return fmt::format("{:>6.2f} {:>8} {:>7} {:>7} {:>8} {:>6.2f}x  {:>7} {:>8} {:>5} {:>8} {:>7} {:>9}",
                     r.references_per_triangle, short_number(r.build_seconds.median), short_number(r.nodes_per_ray),
                     short_number(r.triangles_per_ray), short_number(r.trace_seconds.median), r.speedup,
                     short_number(r.boxes_per_ray), bytes_text(r.bytes), r.depth, short_number(r.sah_cost),
                     r.end_point_overlap ? short_number(*r.end_point_overlap) : "-", r.hits);
}

std::string row_text(const StudyResult& result, size_t width) {
  const std::vector<std::string> lines = folded(result.row);
  std::string text;
  for (size_t i = 0; i + 1 < lines.size(); ++i) text += lines[i] + "\n";
  text += fmt::format("{:<{}} {}\n", lines.back(), width,
                      result.finished ? figures(result) : "not finished: " + result.why_not);
  text += room_line(result.short_of_room);
  if (result.paper) {
    const PaperRow& p = *result.paper;
    text += fmt::format("{:<{}} {:>6.2f} {:>8} {:>7} {:>7} {:>8} {:>6.2f}x\n", "  the paper", width,
                        p.references_per_triangle, short_number(p.build_seconds), short_number(p.nodes_per_ray),
                        short_number(p.triangles_per_ray), short_number(p.trace_seconds), p.speedup);
  }
  return text;
}

}  // namespace

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

std::string room_line(std::span<const std::string> short_of_room) {
  if (short_of_room.empty()) return "";
  return fmt::format("  {}: raise --limit-gigabytes\n", room_sentence(short_of_room));
}

std::string bytes_text(size_t bytes) {
  const auto size = static_cast<double>(bytes);
  if (size < 1e3) return fmt::format("{} B", bytes);
  if (size < 1e6) return fmt::format("{:.{}f} kB", size / 1e3, size < 1e4 ? 1 : 0);
  if (size < 1e9) return fmt::format("{:.{}f} MB", size / 1e6, size < 1e7 ? 1 : 0);
  return fmt::format("{:.1f} GB", size / 1e9);
}

std::string text_tables(std::span<const StudyResult> results) {
  const size_t width = width_of(results);
  std::string text;
  for (size_t i = 0; i < results.size(); ++i) {
    const StudyResult& result = results[i];
    const bool is_new = i == 0 || results[i - 1].scene != result.scene || results[i - 1].rays != result.rays;
    if (is_new) text += (i > 0 ? "\n" : "") + heading(result, width);
    text += row_text(result, width);
  }
  return text;
}

std::string csv_table(std::span<const StudyResult> results) {
  std::string text =
      "scene,triangles,row,rays,ray_count,finished,why_not,references_per_triangle,build_seconds,build_seconds_least,"
      "build_seconds_most,nodes_per_ray,triangles_per_ray,boxes_per_ray,trace_seconds,trace_seconds_least,"
      "trace_seconds_most,speedup,bytes,depth,sah_cost,end_point_overlap,hits,short_of_room\n";
  for (const StudyResult& r : results) {
    text += fmt::format("{},{},{},{},{},{},{}", csv_field(r.scene), r.triangles, csv_field(r.row), r.rays, r.ray_count,
                        r.finished, csv_field(r.why_not));
    if (r.finished) {
      text += fmt::format(
          ",{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", r.references_per_triangle, r.build_seconds.median,
          r.build_seconds.least, r.build_seconds.most, r.nodes_per_ray, r.triangles_per_ray, r.boxes_per_ray,
          r.trace_seconds.median, r.trace_seconds.least, r.trace_seconds.most, r.speedup, r.bytes, r.depth, r.sah_cost,
          r.end_point_overlap ? fmt::format("{}", *r.end_point_overlap) : "", r.hits, fmt::join(r.short_of_room, "+"));
    } else {
      text += std::string(17, ',') + "\n";
    }
  }
  return text;
}

}  // namespace kerf
