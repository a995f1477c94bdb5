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

/// The geometric mean of what the SAH cost grew by and what boxes grew by per area of what they hold: the first alone
/// cries wolf where the scene itself became harder, the second is blind where the content's own boxes grew.
double growth(const RefitOutcome& before, const RefitOutcome& now) {
  const auto worth = [](const RefitOutcome& tree) {
    const double content = half_area(tree.bounds) * tree.sums.parts;
    return tree.sums.nodes > 0 ? tree.sums.nodes / std::sqrt(content) : 0;
  };
  const double was = worth(before), is = worth(now);
  if (was == is) return 1;
  return was > 0 && std::isfinite(was) ? is / was : std::numeric_limits<double>::infinity();
}

}  // namespace

RestPose::RestPose(const Bvh& bvh, std::span<const Geometry> geometries, std::vector<PrimitiveNumber> left_out,
                   size_t primitives)
    : fragments_(bvh, geometries, primitives), left_out_(std::move(left_out)) {
  if (!bvh.nodes.empty()) built_.bounds = bvh.nodes[0].bounds();
  built_.sums.parts = parts_area(bvh, {fragments_, bvh.slots, geometries});
  report_.bytes = fragments_.bytes() + left_out_.size() * sizeof(PrimitiveNumber);
}

void RestPose::set_built(double sah_cost, size_t bytes) {
  report_.sah_cost = report_.built_sah_cost = sah_cost;
  built_.sums.nodes = sah_cost * half_area(built_.bounds);
  report_.bytes += bytes;
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
  std::set_difference(invalid.begin(), invalid.end(), left_out_.begin(), left_out_.end(), std::back_inserter(now));
  if (!now.empty()) refuse_invalid(moved, now.front(), now.size(), "the scene was not refitted");
}

Box3f RestPose::refit(Structure& structure, std::span<Geometry> built, std::span<const Geometry> moved) {
  const auto start = std::chrono::steady_clock::now();
  check(built, moved);
  for (size_t i = 0; i < built.size(); ++i) built[i] = moved[i];
  const RefitOutcome now = structure.refit(fragments_);
  report_.sah_cost = now.sah_cost();
  report_.growth = growth(built_, now);
  report_.left_out = static_cast<size_t>(std::count_if(left_out_.begin(), left_out_.end(), [&](PrimitiveNumber n) {
    return find_defect(built[n.geometry], n.primitive) == Defect::none &&
           !is_degenerate(built[n.geometry], n.primitive);
  }));
  report_.should_rebuild = report_.growth > kRebuildGrowth || report_.left_out > 0;
  report_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return now.bounds;
}

}  // namespace kerf
