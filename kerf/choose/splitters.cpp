#include "kerf/choose/splitters.h"

#include <utility>

#include "kerf/base/error.h"
#include "kerf/choose/automatic_split.h"
#include "kerf/references/early_split.h"
#include "kerf/references/refine.h"

namespace kerf {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

constexpr double kMostPerPrimitive = 1000;

// The primitives and what was cut of them; the pieces of two attempts beside each other, and those that are gathered.
constexpr size_t kSplitPrimitiveBytes = 2 * sizeof(Reference), kSplitReferenceBytes = 3 * sizeof(Reference);
constexpr size_t kSideBytes = 256;  // of a triangle's sides by place, to be refined by area

constexpr OptionSpec kEarlySplitOptions[] = {
    with_auto({"sa_max", "surface area above which a box is cut, all six faces, squared scene units; auto: chosen",
               kAutomatic, 0, kInfinity, false, true}),
    {"cap", "references per primitive, on average, that are never passed; 2 with sa_max=auto", 16, 1,
     kMostPerPrimitive},
    {"budget", "instead of sa_max: as finely as this many references per primitive allow", 1.5, 1, kMostPerPrimitive},
};

/// Of a limit that was asked for with a cap: whether the room or the cap kept it from that limit.
SplitResult of_limit(SplitResult result, const SplitInput& input, double cap) {
  result.short_of_room = result.capped && input.has_less_than(cap);
  return result;
}

/// The same of a budget, which asks for no limit: to use it up is what was wanted.
SplitResult of_budget(SplitResult result, const SplitInput& input, double budget) {
  result = of_limit(std::move(result), input, budget);
  result.capped = result.short_of_room;
  return result;
}

SplitResult split_early(const SplitInput& input, const OptionValues& values) {
  if (values.is_set("budget")) {
    if (values.is_set("sa_max") || values.is_set("cap")) {
      throw Error(ErrorCode::invalid_option, "early_split", "budget replaces sa_max and cap: give one or the other");
    }
    SplitResult result =
        early_split(input.whole, input.clipper, EarlySplit::with_budget(input.cap(values["budget"])), input.limit);
    return of_budget(std::move(result), input, values["budget"]);
  }
  if (is_automatic(values["sa_max"])) {
    AutomaticSplit automatic;
    if (values.is_set("cap")) automatic.cap = values["cap"];
    return split_automatically(input, automatic);
  }
  return of_limit(early_split(input.whole, input.clipper, {values["sa_max"], input.cap(values["cap"])}, input.limit),
                  input, values["cap"]);
}

constexpr std::string_view kMeasures[] = {"edge", "area"};  // in the order of Refinement::Measure
constexpr OptionSpec kRefineOptions[] = {
    {"edge", "length above which an edge is halved, scene units", kInfinity, 0, kInfinity, false, true},
    {"area", "area above which a triangle is cut in four, squared scene units", kInfinity, 0, kInfinity, false, true},
    {"cap", "references per primitive, on average, that are never passed", 16, 1, kMostPerPrimitive},
    {"budget", "instead of edge and area: as finely as this many references per primitive allow", 4, 1,
     kMostPerPrimitive},
    {"by", "what a budget lowers: the longest edge or the largest area", 0, kMeasures},
};

SplitResult split_by_refinement(const SplitInput& input, const OptionValues& values) {
  const bool by_area = values.is_set("area");
  if (values.is_set("budget")) {
    if (values.is_set("edge") || by_area || values.is_set("cap")) {
      throw Error(ErrorCode::invalid_option, "refine", "budget replaces edge, area and cap: give one or the other");
    }
    const auto measure = static_cast<Refinement::Measure>(static_cast<uint32_t>(values["by"]));
    SplitResult result = refine(input.geometries, input.whole,
                                Refinement::with_budget(input.cap(values["budget"]), measure), input.limit);
    return of_budget(std::move(result), input, values["budget"]);
  }
  if (values.is_set("by")) throw Error(ErrorCode::invalid_option, "refine", "by is of no meaning without budget");
  if (by_area && values.is_set("edge")) {
    throw Error(ErrorCode::invalid_option, "refine", "edge and area are two measures: give one");
  }
  const Refinement::Measure measure = by_area ? Refinement::Measure::area : Refinement::Measure::edge;
  const Refinement wanted{measure, values[by_area ? "area" : "edge"], input.cap(values["cap"])};
  return of_limit(refine(input.geometries, input.whole, wanted, input.limit), input, values["cap"]);
}

constexpr SplitterEntry kSplitters[] = {
    {"early_split", "cuts large primitives into several tight boxes before a tree is built",
     "Ernst, Greiner: Early Split Clipping for Bounding Volume Hierarchies, 2007", kEarlySplitOptions, split_early,
     kSplitPrimitiveBytes, kSplitReferenceBytes},
    {"refine", "cuts large triangles into small ones, for the boxes of a tree only, before it is built",
     "Ernst, Greiner: Early Split Clipping for Bounding Volume Hierarchies, 2007, section 4", kRefineOptions,
     split_by_refinement, kSplitPrimitiveBytes + kSideBytes, kSplitReferenceBytes},
};

}  // namespace

std::span<const SplitterEntry> splitters() { return kSplitters; }

}  // namespace kerf
