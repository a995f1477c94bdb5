#include "kerf/scene/refit.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <string>

#include "kerf/base/error.h"

namespace kerf {
namespace {

std::string describe(const Geometry& geometry) {
  return std::to_string(primitive_count(geometry)) + " " + std::string(kind_name(geometry)) + "s";
}

}  // namespace

RestPose::RestPose(const Bvh& bvh, std::span<const Geometry> geometries, std::vector<PrimitiveNumber> dropped)
    : fragments_(bvh, geometries), dropped_(std::move(dropped)) {
  report_.sah_cost = report_.built_sah_cost = sah_cost(bvh);
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

Box3f RestPose::refit(Structure& structure) {
  const auto start = std::chrono::steady_clock::now();
  const RefitOutcome sums = structure.refit(fragments_);
  report_.sah_cost = sums.sah_cost();
  const bool both = report_.sah_cost > 0 && report_.built_sah_cost > 0;
  const bool neither = report_.sah_cost == report_.built_sah_cost;
  report_.growth = both      ? report_.sah_cost / report_.built_sah_cost
                   : neither ? 1
                             : std::numeric_limits<double>::infinity();
  report_.should_rebuild = report_.growth > kRebuildGrowth;
  report_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return sums.bounds;
}

}  // namespace kerf
