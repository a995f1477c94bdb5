#include "kerf/study/report/columns.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

namespace kerf::report {
namespace {

using Result = StudyResult;

constexpr Column kColumns[] = {
    {"references", "R", "", "references per triangle",
     "Entries in the leaves over triangles of the scene. 1: no triangle was split. Splitting trades memory, which "
     "grows "
     "with R, for tighter boxes.",
     Quantity::number, Best::none, [](const Result& r) { return r.references_per_triangle; }, nullptr,
     [](const PaperRow& p) { return p.references_per_triangle; }},
    {"build", "T", "build", "build time",
     "Time to make the structure from triangles: references, splitting, building and layout.", Quantity::seconds,
     Best::least, [](const Result& r) { return r.build_seconds.median; },
     [](const Result& r) { return &r.build_seconds; }, [](const PaperRow& p) { return p.build_seconds; }},
    {"nodes", "N", "node", "nodes per ray",
     "Nodes whose box the ray enters, on average: the root, inner nodes and leaves alike. Repeats exactly.",
     Quantity::number, Best::least, [](const Result& r) { return r.nodes_per_ray; }, nullptr,
     [](const PaperRow& p) { return p.nodes_per_ray; }},
    {"triangles", "N", "tri", "triangle tests per ray",
     "Triangles that the ray was tested against, on average, repeats included. Falls where boxes fit tightly. Repeats "
     "exactly.",
     Quantity::number, Best::least, [](const Result& r) { return r.triangles_per_ray; }, nullptr,
     [](const PaperRow& p) { return p.triangles_per_ray; }},
    {"trace", "T", "ray", "ray time",
     "Time to trace all rays on one thread, without making or shading them: what all the rest is for.",
     Quantity::seconds, Best::least, [](const Result& r) { return r.trace_seconds.median; },
     [](const Result& r) { return &r.trace_seconds; }, [](const PaperRow& p) { return p.trace_seconds; }},
    {"speedup", "S", "", "speed-up",
     "How many times as fast as the first row that finished: the median of runs in pairs, so that it may differ a "
     "little from the ratio of the two medians.",
     Quantity::ratio, Best::most, [](const Result& r) { return r.speedup; }, nullptr,
     [](const PaperRow& p) { return p.speedup; }},
    {"boxes", "N", "box", "box tests per ray",
     "Boxes that the ray was tested against, on average, entered or not. Repeats exactly.", Quantity::number,
     Best::least, [](const Result& r) { return r.boxes_per_ray; }, nullptr, nullptr},
    {"bytes", "Bytes", "", "memory", "Memory of the finished structure. 1 kB is 1000 bytes.", Quantity::bytes,
     Best::least, [](const Result& r) { return static_cast<double>(r.bytes); }, nullptr, nullptr},
    {"depth", "Depth", "", "levels", "Nodes on the longest way from the root to a leaf.", Quantity::count, Best::none,
     [](const Result& r) { return static_cast<double>(r.depth); }, nullptr, nullptr},
    {"sah", "SAH", "", "cost",
     "Surface area heuristic: the work that a long random ray is expected to do, every box weighted by its area over "
     "the root's. It sees neither where rays end nor what they miss.",
     Quantity::number, Best::none, [](const Result& r) { return r.sah_cost; }, nullptr, nullptr},
    {"overlap", "EPO", "", "end-point overlap",
     "The work that rays are expected to do because they end on surfaces inside boxes that those surfaces do not "
     "belong to (Aila, Karras, Laine 2013). 0: boxes do not overlap. \xE2\x80\x93: not asked for.",
     Quantity::number, Best::none,
     [](const Result& r) { return r.end_point_overlap.value_or(std::numeric_limits<double>::quiet_NaN()); }, nullptr,
     nullptr},
    {"hits", "Hits", "", "rays that hit", "Rays that hit anything. All rows of a table have to agree.", Quantity::count,
     Best::none, [](const Result& r) { return static_cast<double>(r.hits); }, nullptr, nullptr},
};

}  // namespace

std::span<const Column> columns() { return kColumns; }

const Column& column(std::string_view id) {
  const auto* const found =
      std::find_if(std::begin(kColumns), std::end(kColumns), [&](const Column& c) { return c.id == id; });
  assert(found != std::end(kColumns));
  return *found;
}

Unit column_unit(const Column& column, std::span<const StudyResult* const> results) {
  if (column.quantity != Quantity::seconds && column.quantity != Quantity::bytes) return {};
  std::vector<double> values;
  for (const StudyResult* result : results) {
    const double value = result->finished ? column.value(*result) : 0;
    if (value > 0 && std::isfinite(value)) values.push_back(value);
  }
  std::sort(values.begin(), values.end());
  const double middle = values.empty() ? 1 : values[values.size() / 2];
  return column.quantity == Quantity::seconds ? time_unit(middle) : byte_unit(middle);
}

std::string value_text(const Column& column, double value, const Unit& unit) {
  switch (column.quantity) {
    case Quantity::count:
      return count_text(static_cast<uint64_t>(value));
    case Quantity::ratio:
      return number_text(value) + "\xC3\x97";
    default:
      return number_text(value / unit.size);
  }
}

}  // namespace kerf::report
