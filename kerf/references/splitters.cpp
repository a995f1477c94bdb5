#include "kerf/references/splitters.h"

#include "kerf/base/error.h"
#include "kerf/references/early_split.h"

namespace kerf {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

constexpr double kMostPerPrimitive = 1000;

constexpr OptionSpec kEarlySplitOptions[] = {
    {"sa_max", "surface area above which a box is cut, all six faces, squared scene units", kInfinity, 0, kInfinity,
     false, true},
    {"cap", "references per primitive, on average, that are never passed", 16, 1, kMostPerPrimitive},
    {"budget", "instead of sa_max: as finely as this many references per primitive allow", 1.5, 1, kMostPerPrimitive},
};

SplitResult split_early(const SplitInput& input, const OptionValues& values) {
  if (values.is_set("budget")) {
    if (values.is_set("sa_max") || values.is_set("cap")) {
      throw Error(ErrorCode::invalid_option, "early_split", "budget replaces sa_max and cap: give one or the other");
    }
    SplitResult result = early_split(input.whole, input.clipper, EarlySplit::with_budget(values["budget"]));
    result.capped = false;  // no limit was asked for
    return result;
  }
  return early_split(input.whole, input.clipper, {values["sa_max"], values["cap"]});
}

constexpr SplitterEntry kSplitters[] = {
    {"early_split", "cuts large primitives into several tight boxes before a tree is built",
     "Ernst, Greiner: Early Split Clipping for Bounding Volume Hierarchies, 2007", kEarlySplitOptions, split_early},
};

}  // namespace

std::span<const SplitterEntry> splitters() { return kSplitters; }

}  // namespace kerf
