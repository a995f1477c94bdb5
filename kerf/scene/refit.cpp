#include "kerf/scene/refit.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <string>

#include "kerf/base/error.h"

namespace kerf {
namespace {

std::string describe(const Geometry& geometry) {
  return std::to_string(primitive_count(geometry)) + " " + std::string(kind_name(geometry)) + "s";
}

/// See docs/refit.md. Half the logarithm of what the cost grew by, half that of what boxes grew by per area of their
/// content; as the square of the nodes' sum over the areas of root and content.
double growth(const RefitOutcome& before, const RefitOutcome& now) {
  const auto worth = [](const RefitOutcome& tree) {
    const double content = half_area(tree.bounds) * tree.sums.parts;
    return content > 0 ? tree.sums.nodes / std::sqrt(content) : 0;
  };
  const double was = worth(before), is = worth(now);
  if (was == is) return 1;
  return was > 0 ? is / was : std::numeric_limits<double>::infinity();
}

}  // namespace

RestPose::RestPose(const Bvh& bvh, std::span<const Geometry> geometries, std::vector<PrimitiveNumber> dropped)
    : fragments_(bvh, geometries), dropped_(std::move(dropped)) {
  if (!bvh.nodes.empty()) built_.bounds = bvh.nodes[0].bounds();
  report_.sah_cost = report_.built_sah_cost = sah_cost(bvh);
  built_.sums.nodes = report_.sah_cost * half_area(built_.bounds);
  built_.sums.parts = parts_area(bvh, {fragments_, bvh.slots, geometries});
  report_.left_out = dropped_.size();
  report_.bytes = fragments_.bytes() + dropped_.size() * sizeof(PrimitiveNumber);
}

void RestPose::check(std::span<const Geometry> built, std::span<const Geometry> moved) const {
  if (moved.size() != built.size()) {
    throw Error(ErrorCode::invalid_argument, "refit",
                std::to_string(moved.size()) + " geometries, but " + std::to_string(built.size()) + " were built");
  }
  for (size_t i = 0; i < built.size(); ++i) {
    const std::string expected = describe(built[i]), given = describe(moved[i]);
    if (given == expected) continue;
    throw Error(ErrorCode::invalid_argument, "refit, geometry " + std::to_string(i),
                given + ", but " + expected + " were built");
  }
  const std::vector<PrimitiveNumber> invalid = find_invalid(moved);
  std::vector<PrimitiveNumber> now;
  std::set_difference(invalid.begin(), invalid.end(), dropped_.begin(), dropped_.end(), std::back_inserter(now));
  if (!now.empty()) refuse_invalid(moved, now.front(), now.size(), "the scene was not refitted");
}

Box3f RestPose::refit(Structure& structure, std::span<Geometry> built, std::span<const Geometry> moved) {
  const auto start = std::chrono::steady_clock::now();
  check(built, moved);
  for (size_t i = 0; i < built.size(); ++i) built[i] = moved[i];
  const RefitOutcome now = structure.refit(fragments_);
  report_.sah_cost = now.sah_cost();
  report_.growth = growth(built_, now);
  report_.should_rebuild = report_.growth > kRebuildGrowth;
  report_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return now.bounds;
}

}  // namespace kerf
